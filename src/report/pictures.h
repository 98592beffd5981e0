/* The report's PNG files. Private to src/report. */
#ifndef PEEL_REPORT_PICTURES_H
#define PEEL_REPORT_PICTURES_H

#include "study/threeway.h"

enum {
    PICTURES_NAME = 48
};

/* Names inside the report's folder. */
const char *pictures_final(int renderer, char out[PICTURES_NAME]); /* "ref.png" */
const char *pictures_difference(const PairReport *pair, char out[PICTURES_NAME]);
/* The difference as the page shows it: each pixel the greatest of block·block pixels. */
const char *pictures_preview(const PairReport *pair, int block, char out[PICTURES_NAME]);
int pictures_block(const Threeway *report);
const char *pictures_accum(const PeelPicture *peel, char out[PICTURES_NAME]);
const char *pictures_added(const PeelPicture *peel, char out[PICTURES_NAME]);
#define PICTURES_SCALE "scale.png"

/* Writes them all into dir, which exists. Thumbnails are display-transformed, c/(c + 1) to the
 * power 1/2.2; where a layer has no fragment they show a checkerboard. */
Result pictures_write(const Threeway *report, const char *dir);

/* The legend alone. */
Result pictures_write_scale(const char *dir);

/* Removes the pictures of peels that are not among the report's: files that pictures_accum and
 * pictures_added name, and no others. IO with a message when one stays. */
Result pictures_remove_stale(const Threeway *report, const char *dir);

/* dir/name, allocated; NULL and a message when memory is exhausted. */
char *pictures_path(const char *dir, const char *name);

#endif
