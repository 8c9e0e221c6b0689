// Tests by bit pattern. max, min, clamp and pow turn a NaN into a number on some drivers, so look before they are called.
#ifndef SAMPLERSCOPE_FINITE
#define SAMPLERSCOPE_FINITE

bool is_nonfinite(float x) {
#ifdef DOUBLE_PRECISION
    return isnan(x) || isinf(x); // a double beyond the range of float is finite
#else
    return (floatBitsToUint(x) & 0x7f800000u) == 0x7f800000u;
#endif
}

#endif
