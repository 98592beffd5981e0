/* What a page of `peel explain` carries, as JSON. Private to src/report. */
#ifndef PEEL_REPORT_EXPLAIN_DATA_H
#define PEEL_REPORT_EXPLAIN_DATA_H

#include "base/text.h"
#include "report/explain.h"

/* Bytes of the page by what they are of. */
typedef struct ExplainRoom {
    size_t program, scene, gl, truth;
} ExplainRoom;

/* One object, without a '<' in it, so that it can stand in a script element.
 *
 * lesson, of a lesson's page alone: {number, titles}
 *
 * program: {version, command, name, size: [2], settings: [[name, value]], values for engine_set;
 * methods: [{name, summary, paper, exact}]}
 *
 * wasm, scene: packed bytes.
 *
 * ref: {checksums: [[buffer, FNV-1a as 8 hexadecimal digits]], figures}
 *
 * gl: {missing: why}, or {renderer, version, figures, buffers: [{name, differing, difference}]}: of
 * each traced buffer how many bytes differ from ref's, and where some do, those bytes xor ref's,
 * packed.
 *
 * truth: {missing: why}, or {differing, max_abs, rmse, nonfinite, figures, final}; final, packed:
 * the bits of its image xor ref's, first the first bytes of all, then the second ones, …
 *
 * Packed: deflated (RFC 1950), in base64. The caller frees out, whatever is returned. */
Result explain_data(const ExplainDesc *explain, Text *out, ExplainRoom *room);

#endif
