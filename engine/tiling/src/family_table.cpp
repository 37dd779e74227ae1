#include "supple/tiling/family.h"
