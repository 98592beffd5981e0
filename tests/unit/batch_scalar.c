#define LANES       1
#define BATCH_TABLE batch_scalar
#include "batch_table.h"
