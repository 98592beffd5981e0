/* To come. */
"use strict";
