/* number/op.h with flushing computed in software, whatever the processor can do. */
#ifndef PEEL_SOFTWARE_FLUSH
#define PEEL_SOFTWARE_FLUSH
#endif
#define OP_TABLE op_software
#include "op_table.h"
