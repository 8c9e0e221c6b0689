// Arc functions good to a few float32 ulp. Drivers may be far worse: lavapipe's asin is off by 4e-4.
#ifndef SAMPLERSCOPE_ARC
#define SAMPLERSCOPE_ARC

const float HALF_PI = 1.57079632679489662;

#ifdef DOUBLE_PRECISION // a file widened to double: the polynomial below ends at float32

float arcsine(float x) { return asin(x); }

#else

// asin(x) for 0 <= x <= 0.5, as x + x^3 P(x^2); coefficients of the Cephes library (asinf.c).
float arcsine_small(float x) {
    float t = x * x;
    float p = 4.2163199048e-2;
    p = p * t + 2.4181311049e-2;
    p = p * t + 4.5470025998e-2;
    p = p * t + 7.4953002686e-2;
    p = p * t + 1.6666752422e-1;
    return x + x * t * p;
}

// asin(x) for 0 <= x <= 1. Above 0.5 the half-angle form keeps the accuracy where the slope is infinite.
float arcsine(float x) {
    bool large = x > 0.5;
    float y = arcsine_small(large ? sqrt(0.5 * (1.0 - x)) : x);
    return large ? HALF_PI - 2.0 * y : y;
}

#endif

// The angle of w to the normal, from its sine where that is the smaller part: accurate at the normal and at grazing.
float polar_angle(vec3 w) {
    float sine = length(w.xy);
    return sine < abs(w.z) ? arcsine(sine) : HALF_PI - arcsine(w.z);
}

#endif
