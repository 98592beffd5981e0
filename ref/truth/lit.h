/* A fragment's colour, and what it makes of those in front of it. */
#ifndef PEEL_REF_TRUTH_LIT_H
#define PEEL_REF_TRUTH_LIT_H

#include "ref/truth/order.h"
#include "ref/truth/radiance.h"

/* What a fragment sends to the eye, not multiplied by alpha, and where it is. */
typedef struct Lit {
    double rgb[3], alpha;
    double z;        /* distance along the view axis */
    Surface surface; /* as it was shaded */
} Lit;

/* (x, y): y up. Colour and alpha are 0 where the alpha test discards the fragment. */
void lit_fragment(const Soup *soup, const RenderDesc *desc, const Fragment *fragment, int x, int y,
                  Lit *out);

/* Puts the fragment behind rgba: premultiplied colour so far, and transmittance. */
void lit_blend(const Lit *lit, double rgba[4]);

#endif
