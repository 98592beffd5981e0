#define _GNU_SOURCE /* asprintf */
#include "scene/gltf_assimp.h"

#include "base/file.h"
#include "base/json_memory.h"
#include "base/memory.h"
#include "scene/gltf_file.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/metadata.h>
#include <assimp/scene.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A file in memory with a position: all that Assimp ever reads. */
typedef struct MemoryFile {
    const unsigned char *bytes;
    size_t count, position;
    unsigned char *owned; /* NULL for the document itself */
} MemoryFile;

typedef struct Document {
    const char *path;
    const GltfJson *json;
    unsigned char *bytes;
    size_t count;
    bool out_of_memory; /* a file could not be opened for want of it */
} Document;

static size_t file_read(struct aiFile *file, char *out, size_t size, size_t count)
{
    MemoryFile *memory = (MemoryFile *)file->UserData;
    size_t left = memory->count - memory->position;
    size_t items = size && count > left / size ? left / size : count;
    if (size == 0)
        return 0;
    memcpy(out, memory->bytes + memory->position, items * size);
    memory->position += items * size;
    return items;
}

static size_t file_write_nothing(struct aiFile *file, const char *bytes, size_t size, size_t count)
{
    (void)file, (void)bytes, (void)size, (void)count;
    return 0;
}

static size_t file_tell(struct aiFile *file)
{
    return ((MemoryFile *)file->UserData)->position;
}

static size_t file_size(struct aiFile *file)
{
    return ((MemoryFile *)file->UserData)->count;
}

static aiReturn file_seek(struct aiFile *file, size_t offset, enum aiOrigin origin)
{
    MemoryFile *memory = (MemoryFile *)file->UserData;
    size_t base = origin == aiOrigin_SET   ? 0
                  : origin == aiOrigin_CUR ? memory->position
                                           : memory->count;
    if (offset > memory->count - base)
        return aiReturn_FAILURE;
    memory->position = base + offset;
    return aiReturn_SUCCESS;
}

static void file_flush(struct aiFile *file)
{
    (void)file;
}

static void close_file(struct aiFileIO *io, struct aiFile *file)
{
    (void)io;
    if (!file)
        return;
    free(((MemoryFile *)file->UserData)->owned);
    free(file->UserData);
    free(file);
}

/* As many as the reduced document may say that there are more. The caller frees *bytes, after a
 * failure too. */
static Result add_zeros(unsigned char **bytes, size_t *count)
{
    unsigned char *longer = realloc(*bytes, *count + GLTF_STRIDE_END);
    if (!longer)
        return RESULT_NO_MEMORY;
    memset(longer + *count, 0, GLTF_STRIDE_END);
    *bytes = longer;
    *count += GLTF_STRIDE_END;
    return RESULT_OK;
}

/* The buffer that path, joined to the document's folder, is the number of. */
static Result read_buffer(const Document *document, const char *path, MemoryFile *out)
{
    const char *slash = strrchr(path, '/');
    size_t index = strtoul(slash ? slash + 1 : path, NULL, 10);
    const json_t *buffer = gltf_json_element(document->json, "buffers", index);
    const char *uri = json_string_value(json_object_get(buffer, "uri"));
    if (!uri)
        return RESULT_BAD_INPUT;
    Result result = gltf_file_uri(document->path, "buffer", index, uri, &out->owned, &out->count);
    if (result == RESULT_OK)
        result = add_zeros(&out->owned, &out->count);
    out->bytes = out->owned;
    return result;
}

/* The reduced document under the file's own name; everything else is a buffer. */
static struct aiFile *open_file(struct aiFileIO *io, const char *path, const char *mode)
{
    Document *document = (Document *)io->UserData;
    if (mode[0] != 'r')
        return NULL;
    struct aiFile *file = memory_array(1, sizeof *file);
    MemoryFile *memory = memory_array(1, sizeof *memory);
    Result result = file && memory ? RESULT_OK : RESULT_NO_MEMORY;
    if (result == RESULT_OK && strcmp(path, document->path) == 0)
        *memory = (MemoryFile){.bytes = document->bytes, .count = document->count};
    else if (result == RESULT_OK)
        result = read_buffer(document, path, memory);
    if (result != RESULT_OK) {
        document->out_of_memory |= result == RESULT_NO_MEMORY;
        free(file);
        if (memory)
            free(memory->owned);
        free(memory);
        return NULL;
    }
    *file = (struct aiFile){file_read, file_write_nothing, file_tell,         file_size,
                            file_seek, file_flush,         (aiUserData)memory};
    return file;
}

/* Whether it has to be given to Assimp as binary, which takes the first buffer for the BIN chunk
 * whatever its uri says. */
static bool is_binary(const char *path, const GltfJson *json)
{
    const json_t *first = gltf_json_element(json, "buffers", 0);
    return gltf_file_kind(path) == 1 && !json_object_get(first, "uri");
}

/* text and the BIN chunk, which is `wanted` bytes long at least. */
static Result assemble(const GltfJson *json, const char *text, size_t wanted, Document *document)
{
    size_t count = json->binary_count;
    unsigned char *longer = NULL;
    if (wanted > count) {
        longer = memory_array(wanted, 1);
        if (!longer)
            return RESULT_NO_MEMORY;
        memcpy(longer, json->binary, count);
        count = wanted;
    }
    Result result = gltf_file_assemble(text, longer ? longer : json->binary, count,
                                       &document->bytes, &document->count);
    free(longer);
    return result;
}

/* The reduced document as text, or binary with the same BIN chunk. */
static Result serialize(const char *path, const GltfJson *json, Document *document)
{
    json_memory_begin();
    json_t *reduced = gltf_json_reduced(json);
    const json_t *first = json_array_get(json_object_get(reduced, "buffers"), 0);
    size_t wanted = gltf_json_index(first, "byteLength", 0);
    char *text = json_dumps(reduced, JSON_COMPACT | JSON_REAL_PRECISION(17));
    json_decref(reduced);
    Result whole = json_memory_check(path, RESULT_OK);
    if (whole) {
        free(text);
        return whole;
    }
    if (!is_binary(path, json)) {
        document->bytes = (unsigned char *)text;
        document->count = strlen(text);
        return RESULT_OK;
    }
    Result result = assemble(json, text, wanted, document);
    free(text);
    return result;
}

/* Assimp's message may have several lines; ours has one. */
static Result assimp_failure(const char *path)
{
    char message[512];
    snprintf(message, sizeof message, "%s", aiGetErrorString());
    message[strcspn(message, "\r\n")] = 0;
    if (strstr(message, "std::bad_alloc"))
        return result_fail(RESULT_NO_MEMORY, "%s: out of memory for Assimp", path);
    return result_fail(RESULT_BAD_INPUT, "%s: cannot import: %s", path,
                       *message ? message : "no reason given");
}

/* Assimp guesses formats by content; nothing but its glTF 2.0 importer may have answered. */
static bool is_gltf2(const struct aiScene *scene)
{
    struct aiString format = {0};
    for (unsigned i = 0; scene->mMetaData && i < scene->mMetaData->mNumProperties; i++) {
        const struct aiMetadataEntry *entry = &scene->mMetaData->mValues[i];
        if (strcmp(scene->mMetaData->mKeys[i].data, "SourceAsset_Format") == 0 &&
            entry->mType == AI_AISTRING)
            memcpy(&format, entry->mData, sizeof format);
    }
    return strcmp(format.data, "glTF2 Importer") == 0;
}

Result gltf_assimp_import(const char *path, const GltfJson *json, const struct aiScene **out)
{
    Document document = {.json = json};
    *out = NULL;
    /* Assimp knows text by the name. */
    char *name = NULL;
    if (asprintf(&name, "%s%s", path, is_binary(path, json) ? "" : ".gltf") < 0)
        return result_fail(RESULT_NO_MEMORY, "%s: out of memory to import it", path);
    document.path = name;
    Result result = serialize(path, json, &document);
    if (result) {
        free(name);
        return result;
    }
    /* No log stream is attached: Assimp then logs nowhere. */
    struct aiFileIO io = {open_file, close_file, (aiUserData)&document};
    *out = aiImportFileEx(name, 0, &io);
    if (document.out_of_memory)
        result = result_fail(RESULT_NO_MEMORY, "%s: out of memory to import it", path);
    else if (!*out)
        result = assimp_failure(path);
    else if (!is_gltf2(*out) || !(*out)->mRootNode)
        result = result_fail(RESULT_BAD_INPUT, "%s: not read as glTF 2.0", path);
    free(document.bytes);
    free(name);
    return result;
}

void gltf_assimp_release(const struct aiScene *scene)
{
    if (scene)
        aiReleaseImport(scene);
}
