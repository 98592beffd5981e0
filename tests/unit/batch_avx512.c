#define LANES       16
#define BATCH_TABLE batch_avx512
#include "batch_table.h"
