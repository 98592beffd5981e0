/* The settings of a RenderDesc that are one of a few names: as the command line and pages have
 * them.
 */
#ifndef PEEL_FRAME_SETTING_H
#define PEEL_FRAME_SETTING_H

#include "frame/render_desc.h"

typedef enum SettingId {
    SETTING_CULL = 0,
    SETTING_NORMALS,
    SETTING_SHADING,
    SETTING_GGX,
    SETTING_BACK_LIGHT,
    SETTING_DEPTH_FUNC,
    SETTING_DEPTH_RANGE,
    SETTING_PEEL_TEST,
    SETTING_GBUFFER,
    SETTING_POSITION,
    SETTING_DEPTH,
    SETTING_ACCUM,
    SETTING_SORT,
    SETTING_WEIGHT,
    SETTING_POST,
    SETTING_SIMD,
    SETTING_MODEL,
    SETTING_COUNT
} SettingId;

enum {
    SETTING_CHOICES_MAX = 6
};

typedef struct SettingInfo {
    const char *name;                         /* "depth-func" */
    const char *choices[SETTING_CHOICES_MAX]; /* the default first; NULL behind the last */
} SettingInfo;

const SettingInfo *setting_info(SettingId id); /* static */
int setting_choice_count(SettingId id);

/* choice: an index into choices. */
void setting_put(RenderDesc *desc, SettingId id, int choice);
int setting_get(const RenderDesc *desc, SettingId id);

#endif
