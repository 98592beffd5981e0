/* What somebody needs to render the same image with a renderer of their own: the contract for
 * producers. */
#ifndef PEEL_REPORT_CONTRACT_H
#define PEEL_REPORT_CONTRACT_H

#include "frame/render_desc.h"
#include "scene/scene.h"

typedef struct ContractDesc {
    const char *name; /* of the scene */
    const Scene *scene;
    RenderDesc desc;
    const char *check; /* the command that checks an image of it, in the folder */
    const char *glsl_constants, *glsl_shade; /* lines of "#define …", and the formula */
} ContractDesc;

/* Writes dir, which exists: scene.gltf, contract.json (camera and matrices, lights, materials,
 * draws, settings; every float as a hexadecimal one in a string), vertices.bin, indices.bin and
 * textures.bin, shade.glsl, peel_shade.h, peel_dump.h and index.html, the page. */
Result report_contract_write(const ContractDesc *contract, const char *dir);

/* The page alone, as one file with its style. */
Result report_contract_page(const char *path);

#endif
