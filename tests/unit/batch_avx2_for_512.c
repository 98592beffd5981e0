#define LANES       8
#define BATCH_TABLE batch_avx2_for_512
#include "batch_table.h"
