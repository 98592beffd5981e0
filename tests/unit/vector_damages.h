/* What may be wrong in a file of vectors, and what is said of it. */
#ifndef PEEL_TESTS_VECTOR_DAMAGES_H
#define PEEL_TESTS_VECTOR_DAMAGES_H

typedef struct Damage {
    const char *from, *to;
    const char *message; /* from the line on; behind the path */
} Damage;

static const Damage csv_damages[] = {
    {"vectors: 1", "vectors: 2", ":1: vectors of version '2', expected 1"},
    {"# peel-blend-vectors: 1\n", "", ":1: expected '# peel-blend-vectors: 1'"},
    {"set: directed", "set: some", ":2: set 'some', expected exhaustive, directed, random"},
    {"format: rgba16f", "format: rgb9", ":3: format 'rgb9', expected rgba8, rgba16, rgba16f"},
    {"format: rgba16f", "format: d24", ":9: no directed vectors of d24"},
    {"equation: under", "equation: below", ":4: equation 'below', expected a name or factors"},
    {"seed: 1", "seed: one", ":5: seed 'one', expected an integer"},
    {"seed: 1", "seed: 9007199254740992", ":5: seed '9007199254740992', expected an integer"},
    {"# seed: 1\n", "", ":8: expected a line '# seed: ...' before this one"},
    {"# seed: 1\n", "# seed: 1\n# seed: 1\n", ":6: 'seed' for the second time"},
    {"count: 9", "count: 99999999", ":9: first 0, count 99999999: the set has"},
    {"count: 9", "count: 8", ":18: expected '# end: 8 CHECKSUM'"},
    {"count: 9", "count: 10", ":19: a comment, expected vector 9 of the 10 from 0"},
    {"source_g,", "", ":9: expected the columns index,source_r,source_g"},
    {"\n3,", "\n3,0x0p+0,", ":13: 14 fields, expected the 13 of the columns"},
    {"\n3,", "\n", ":13: 12 fields, expected the 13 of the columns"},
    {"\n3,", "\n4,", ":13: vector 4, expected 3"},
    {"\n3,", "\nx,", ":13: index 'x', expected an integer"},
    {"\n3,0x0p+0", "\n3,0x0q+0", ":13: source_r is '0x0q+0', expected a hexadecimal float"},
    {"\n3,0x0p+0", "\n3,0.5", ":13: source_r is '0.5', expected a hexadecimal float"},
    {"\n3,0x0p+0", "\n3,-0x0p+0", ":13: source_r is -0x0p+0, expected this vector's 0x0p+0"},
    {"\n3,0x0p+0", "\n3,nan", ":13: source_r is nan, expected this vector's 0x0p+0"},
    {"0x1.fffffcp-127,-0x1p-24", "0x1.fffffcp-127,0x1p-24",
     ":13: destination_r is 0x1p-24, expected this vector's -0x1p-24"},
    {"\n8,", "\n\001\033[2J8,", ":18: index '??[2J8', expected an integer"},
    {"# end: 9", "# end: 8", ":19: the end says 8 vectors, expected 9"},
    {"# end: 9", "# ende: 9", ":19: expected '# end: 9 CHECKSUM'"},
    {"# end: 9 ", "# end: 9 0", ":19: expected '# end: 9 CHECKSUM'"},
    {"# end: 9", "9,", ":19: expected '# end: 9 CHECKSUM'"},
};

static const Damage json_damages[] = {
    {"vectors\":1", "vectors\":2", ":1: vectors of version '2', expected 1"},
    {"peel_blend_vectors", "peel", ":1: expected \"peel_blend_vectors\": 1"},
    {"\"directed\"", "3", ":1: expected \"set\", a text"},
    {"\"directed\"", "\"a\\nb\"", ":1: set 'a?b', expected exhaustive"},
    {"\"exact\"}", "\"exact\"", ":1: column "},
    {"\"seed\":1", "\"seed\":-1", ":1: expected \"seed\", an integer from 0"},
    {"\"index\":3", "\"index\":4", ":5: vector 4, expected 3"},
    {"\"index\":3", "\"index\":3.5", ":5: expected \"index\", an integer"},
    {"\"index\":3", "\"index\":3,\"index\":3", ":5: column "},
    {"{\"index\":3", "[\"index\",3", ":5: column "},
    {"\"source\":[\"0x0p+0\"", "\"source\":[\"0x0\",1", ":2: expected \"source\", an array of 4"},
    {"\"source\":[\"0x0p+0\"", "\"source\":[\"0xz\"", ":2: source_r is '0xz', expected a hex"},
    {"\"source\":[\"0x0p+0\"", "\"source\":[0.1", ":2: source_r is no float: expected a text"},
    {"\"source\":[\"0x0p+0\"", "\"source\":[null", ":2: source_r is no float: expected a text"},
    {"\"result\":[", "\"result\":[\"0x1.001p+0\"],\"was\":[", ":2: expected \"result\", an array"},
    {"\"result\":[\"0x0p+0\"", "\"result\":[\"0x1.001p+0\"",
     ":2: result_r is '0x1.001p+0', which no half is"},
    {"\"result\":[\"0x0p+0\"", "\"result\":[0.1", ":2: result_r is no float"},
    {"\"result\":[\"0x0p+0\"", "\"result\":[65505", ":2: result_r is a number that no half is"},
    {"\"count\":9", "\"count\":10", ":11: the end, expected vector 9 (of 10)"},
    {"\"count\":9", "\"count\":8", ":10: expected the end, {\"end\": true, ...}, after 8 vectors"},
    {"\"end\":true", "\"end\":1", ":11: expected the end"},
    {"true,\"count\":9", "true,\"count\":8", ":11: the end says 8 vectors, expected 9"},
    {"\"checksum\":\"", "\"checksum\":\"\\n\\u001b", ":11: checksum of the operands '??"},
};

#endif
