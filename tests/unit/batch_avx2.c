#define LANES       8
#define BATCH_TABLE batch_avx2
#include "batch_table.h"
