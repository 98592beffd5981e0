/* The definition paths of the methods: one file each. */
#ifndef PEEL_REF_METHODS_H
#define PEEL_REF_METHODS_H

#include "ref/pipeline/pass.h"

/* Each renders the whole frame. frame's images are allocated; trace may be NULL. */
Result dual_render(Pass *pass, TraceSink *trace, Frame *frame);
Result forward_dual_render(Pass *pass, TraceSink *trace, Frame *frame);
Result peel_render(Pass *pass, TraceSink *trace, Frame *frame);
Result peel_id_render(Pass *pass, TraceSink *trace, Frame *frame);
Result linked_list_render(Pass *pass, TraceSink *trace, Frame *frame);
Result forward_render(Pass *pass, TraceSink *trace, Frame *frame);
Result weighted_average_render(Pass *pass, TraceSink *trace, Frame *frame);
Result weighted_sum_render(Pass *pass, TraceSink *trace, Frame *frame);
Result weighted_blended_render(Pass *pass, TraceSink *trace, Frame *frame);
Result painter_render(Pass *pass, TraceSink *trace, Frame *frame);

#endif
