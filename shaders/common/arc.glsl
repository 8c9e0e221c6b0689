// Arc functions good to a few float32 ulp. Drivers may be far worse: lavapipe's asin is off by 4e-4.
#ifndef SAMPLERSCOPE_ARC
#define SAMPLERSCOPE_ARC

const float HALF_PI = 1.57079632679489662;

#ifdef DOUBLE_PRECISION // a file widened to double: the polynomial below ends at float32

float arcsine_small(float x) { return asin(x); }

#else

// asin(x) for |x| <= sqrt(1/2), to 1 ulp: x + x^3 P(x^2), P fitted by iteratively reweighted least squares to the
// relative error of the whole, at most 1.6e-8. Evaluated in pairs (Estrin), which wait less for each other.
float arcsine_small(float x) {
    float t = x * x;
    float t2 = t * t;
    float p = 1.1130191386e-1 * t2 + (7.6956219971e-2 - 9.2594727874e-2 * t);
    p = p * t2 + (4.6501409262e-2 + 1.6394449398e-2 * t);
    p = p * t2 + (1.6666905582e-1 + 7.4884906411e-2 * t);
    return x + x * t * p;
}

#endif

// The angle of the first quadrant that has this sine and this cosine, from the smaller of both: accurate at both ends,
// and without the root that the larger would cost. A negative cosine beyond the sine counts as positive.
float quadrant_angle(float sine, float cosine) {
    bool small = sine < abs(cosine);
    float y = arcsine_small(small ? sine : cosine);
    return small ? y : HALF_PI - y;
}

// The angle of w to the normal; below the horizon to the opposite one, where that is nearer.
float polar_angle(vec3 w) {
    return quadrant_angle(length(w.xy), w.z);
}

#endif
