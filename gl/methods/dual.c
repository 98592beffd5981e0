#include "methods/methods.h"
Result gl_dual(Passes *passes, Frame *out)
{
    (void)passes;
    (void)out;
    return RESULT_INTERNAL;
}
