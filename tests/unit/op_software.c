/* number/op.h with flushing computed in software, whatever the processor can do. */
#define PEEL_SOFTWARE_FLUSH
#define OP_TABLE op_software
#include "op_table.h"
