#include "image/exr_core.h"

#include <stdio.h>
#include <string.h>

static _Thread_local char message[512];

ExrLayout exr_layout(PixelFormat format)
{
    const FormatInfo *info = format_info(format);
    ExrLayout layout = {info->channels, EXR_PIXEL_UINT, 4, info->channel_bytes < 4};
    if (info->kind == KIND_FLOAT)
        layout.type = EXR_PIXEL_FLOAT;
    if (info->kind == KIND_HALF)
        layout = (ExrLayout){info->channels, EXR_PIXEL_HALF, 2, false};
    return layout;
}

const char *exr_channel_name(PixelFormat format, int index)
{
    static const char *const colors[] = {"R", "G", "B", "A"};
    if (format_info(format)->channels > 1)
        return colors[index];
    return format == FORMAT_R32UI ? "ID" : format == FORMAT_R32F ? "R" : "Z";
}

int exr_channel_index(PixelFormat format, const char *name)
{
    for (int i = 0; i < format_info(format)->channels; i++)
        if (strcmp(exr_channel_name(format, i), name) == 0)
            return i;
    return -1;
}

void exr_message_keep(exr_const_context_t context, exr_result_t code, const char *text)
{
    (void)context;
    (void)code;
    if (!message[0])
        snprintf(message, sizeof message, "%s", text);
}

void exr_message_clear(void)
{
    message[0] = 0;
}

const char *exr_message(exr_result_t code)
{
    return message[0] ? message : exr_get_default_error_message(code);
}
