#include "frame/frame.h"

void frame_free(Frame *frame)
{
    image_free(&frame->final);
    image_free(&frame->display);
    *frame = (Frame){0};
}
