#include "ref/pipeline/methods/methods.h"
Result dual_render(Pass *pass, TraceSink *trace, Frame *frame)
{
    (void)pass;
    (void)trace;
    (void)frame;
    return RESULT_INTERNAL;
}
