#include "image/decode_jpeg.h"

#include <setjmp.h>
#include <stdbool.h>
#include <stdio.h>

#include <jerror.h>
#include <jpeglib.h>

enum {
    /* A progressive file has some ten; each takes as long as all of the image. */
    SCANS_MAX = 500
};

typedef struct JpegReader {
    struct jpeg_decompress_struct info;
    struct jpeg_error_mgr errors;
    struct jpeg_progress_mgr progress;
    jmp_buf failed;
    const char *label;
    Result result;
} JpegReader;

/* ---- failures: libjpeg calls these ----------------------------------------------------------- */

static void give_up(JpegReader *reader, Result result, const char *reason)
{
    if (result == RESULT_NO_MEMORY)
        reader->result = result_fail(result, "%s: out of memory for its pixels", reader->label);
    else
        reader->result =
            result_fail(result, "%s: cannot decode the JPEG: %s", reader->label, reason);
    longjmp(reader->failed, 1);
}

static void on_error(j_common_ptr info)
{
    char reason[JMSG_LENGTH_MAX];
    info->err->format_message(info, reason);
    give_up((JpegReader *)info,
            info->err->msg_code == JERR_OUT_OF_MEMORY ? RESULT_NO_MEMORY : RESULT_BAD_INPUT,
            reason);
}

/* Level −1: a warning, behind which libjpeg goes on with grey. */
static void on_message(j_common_ptr info, int level)
{
    int code = info->err->msg_code;
    bool harmless = code == JWRN_EXTRANEOUS_DATA || code == JWRN_JFIF_MAJOR;
    if (level < 0 && !harmless)
        on_error(info);
}

static void on_progress(j_common_ptr info)
{
    JpegReader *reader = (JpegReader *)info;
    if (reader->info.input_scan_number > SCANS_MAX)
        give_up(reader, RESULT_BAD_INPUT, "it has more than 500 scans");
}

/* ---- reading --------------------------------------------------------------------------------- */

static void begin(JpegReader *reader, const unsigned char *bytes, size_t count)
{
    reader->progress.progress_monitor = on_progress;
    jpeg_create_decompress(&reader->info);
    reader->info.progress = &reader->progress;
    jpeg_mem_src(&reader->info, bytes, count);
    jpeg_read_header(&reader->info, TRUE);
}

/* Of CMYK with 255 for no ink, which is how Adobe's files have it, and others not. */
static void mix(const JpegReader *reader, unsigned char *row)
{
    for (JDIMENSION x = 0; x < reader->info.output_width; x++, row += 4) {
        int flip = reader->info.saw_Adobe_marker ? 0 : 255, black = row[3] ^ flip;
        for (int c = 0; c < 3; c++)
            row[c] = (unsigned char)(((row[c] ^ flip) * black + 127) / 255);
        row[3] = 255;
    }
}

static void read_pixels(JpegReader *reader, Image *out)
{
    struct jpeg_decompress_struct *info = &reader->info;
    bool inks = info->jpeg_color_space == JCS_CMYK || info->jpeg_color_space == JCS_YCCK;
    info->out_color_space = inks ? JCS_CMYK : JCS_EXT_RGBA;
    info->dct_method = JDCT_ISLOW; /* the same on every processor */
    if (image_create((int)info->image_width, (int)info->image_height, FORMAT_RGBA8, out) !=
        RESULT_OK)
        give_up(reader, RESULT_NO_MEMORY, NULL);
    jpeg_start_decompress(info);
    while (info->output_scanline < info->output_height) {
        unsigned char *row = image_pixel(out, 0, (int)info->output_scanline);
        jpeg_read_scanlines(info, &row, 1);
        if (inks)
            mix(reader, row);
    }
    jpeg_finish_decompress(info);
}

/* out NULL: the header alone. */
static Result read_jpeg(JpegReader *reader, const unsigned char *bytes, size_t count,
                        const char *label, Image *out)
{
    *reader = (JpegReader){.label = label};
    reader->info.err = jpeg_std_error(&reader->errors);
    reader->errors.error_exit = on_error;
    reader->errors.emit_message = on_message;
    if (setjmp(reader->failed) == 0) {
        begin(reader, bytes, count);
        if (out)
            read_pixels(reader, out);
    } else if (out) {
        image_free(out);
    }
    jpeg_destroy_decompress(&reader->info);
    return reader->result;
}

Result decode_jpeg_size(const unsigned char *bytes, size_t count, const char *label, int *width,
                        int *height, int *channels)
{
    JpegReader reader;
    Result result = read_jpeg(&reader, bytes, count, label, NULL);
    *width = (int)reader.info.image_width;
    *height = (int)reader.info.image_height;
    *channels = reader.info.num_components >= 3 ? 3 : 1;
    return result;
}

Result decode_jpeg_image(const unsigned char *bytes, size_t count, const char *label, Image *out)
{
    JpegReader reader;
    *out = (Image){0};
    return read_jpeg(&reader, bytes, count, label, out);
}
