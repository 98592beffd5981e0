#include "frame/frame.h"

void frame_free(Frame *frame)
{
    image_free(&frame->final);
    image_free(&frame->display);
    image_free(&frame->bound);
    image_free(&frame->rounding);
    *frame = (Frame){0};
}
