/* Names and checksums. */
#include "blend/vector_file.h"

#include "blend/vector_parts.h"

#include <nettle/sha2.h>
#include <stdlib.h>

struct VectorDigest {
    struct sha256_ctx state;
};

const char *vector_form_name(VectorForm form)
{
    static const char *const names[VECTOR_FORM_COUNT] = {"csv", "jsonl", "binary"};
    return names[form];
}

VectorDigest *vector_digest_create(void)
{
    VectorDigest *digest = malloc(sizeof *digest);
    if (digest)
        sha256_init(&digest->state);
    else
        result_fail(RESULT_NO_MEMORY, "checksum: out of memory");
    return digest;
}

void vector_digest_put(VectorDigest *digest, const void *bytes, size_t size)
{
    sha256_update(&digest->state, size, bytes);
}

void vector_digest_finish(VectorDigest *digest, char out[VECTOR_DIGEST_TEXT])
{
    unsigned char bytes[SHA256_DIGEST_SIZE];
    sha256_digest(&digest->state, sizeof bytes, bytes);
    free(digest);
    for (size_t i = 0; i < sizeof bytes; i++) {
        *out++ = "0123456789abcdef"[bytes[i] >> 4];
        *out++ = "0123456789abcdef"[bytes[i] & 15];
    }
    *out = 0;
}
