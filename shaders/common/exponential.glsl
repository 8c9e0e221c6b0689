// reflectance scale exp(x) / (a b), finite wherever the result is: exp may underflow, and 1/(a b) overflow, on the way to a
// number that float32 has. Powers of two are summed as integers and applied last.
#ifndef SAMPLERSCOPE_EXPONENTIAL
#define SAMPLERSCOPE_EXPONENTIAL

float power_of_two(int k) {
    return uintBitsToFloat(uint(k + 127) << 23);
}

// For a reflectance in [0, 1], 0 <= scale < 1e20 and a, b in (0, 4); a divisor of 0 counts as 2^-157.
float exponential_ratio(float reflectance, float scale, float x, float a, float b) {
    x = clamp(x, -650.0, 650.0); // where a b no longer makes up for exp
#ifdef DOUBLE_PRECISION // its range is wide enough, and the polynomial ends at float32
    return reflectance * scale / a / b * exp(x);
#else
    float k = floor(x * 1.44269504088896341 + 0.5);
    float r = (x - k * 0.693359375) + k * 2.12194440e-4; // ln 2 in two parts; polynomial: Cephes library, expf.c
    float p = ((((1.9875691500e-4 * r + 1.3981999507e-3) * r + 8.3334519073e-3) * r + 4.1665795894e-2) * r
        + 1.6666665459e-1) * r + 5.0000001201e-1;
    // 2^60 over 2^30 2^30: tiny reflectances and denormal divisors keep their digits.
    uint first = floatBitsToUint(a * 1073741824.0), second = floatBitsToUint(b * 1073741824.0);
    float divisor = uintBitsToFloat((first & 0x7fffffu) | 0x3f800000u) * uintBitsToFloat((second & 0x7fffffu) | 0x3f800000u);
    float dividend = reflectance * 1152921504606846976.0 * scale * (p * r * r + r + 1.0);
    int power = clamp(int(k) - (int(first >> 23u) + int(second >> 23u) - 254), -252, 254);
    return dividend / divisor * power_of_two(power / 2) * power_of_two(power - power / 2);
#endif
}

#endif
