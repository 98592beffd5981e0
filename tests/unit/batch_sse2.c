#define LANES       4
#define BATCH_TABLE batch_sse2
#include "batch_table.h"
