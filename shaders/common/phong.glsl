// The anisotropic Phong distribution of half vectors, with its sampling.
// Source: Ashikhmin and Shirley, "An Anisotropic Phong BRDF Model" (2000), eq. 4 to 10. nu = nv is Blinn's.
#ifndef SAMPLERSCOPE_PHONG
#define SAMPLERSCOPE_PHONG

#include "common/circle.glsl"
#include "common/half-vector.glsl"
#include "common/logarithm.glsl"

// log of (n.h)^exponent for the exponent at the azimuth of h, as -exponent/2 log(1 + tan^2): a pow of a cosine that float32
// cannot tell from 1 is off by 6e-4 at exponent 2e4. 0 at the normal, where the exponent as printed is 0/0.
float phong_exponent(HalfVector h, float nu, float nv) {
    float series = h.tangent2 > 0.0 ? log_one_plus(h.tangent2) / h.tangent2 : 1.0;
    return -0.5 * series * (nu * h.slope.x * h.slope.x + nv * h.slope.y * h.slope.y);
}

// The density of h per steradian at the normal.
float phong_scale(float nu, float nv) {
    return sqrt(nu + 1.0) * sqrt(nv + 1.0) * 0.159154943091895; // 1/(2 pi)
}

// Density of wi.
float phong_density(HalfVector h, float nu, float nv) {
    return reflected_density(1.0, phong_scale(nu, nv), phong_exponent(h, nu, nv), h);
}

// Slope of a half vector with that density. tan^2 = (1 - u1)^(-2/(1 + e)) - 1, e the exponent at its azimuth.
vec2 phong_slope(vec2 u, float nu, float nv) {
    vec2 azimuth = normalize(sqrt(vec2(nv, nu) + 1.0) * point_on_circle(u.y));
    float exponent = nu * azimuth.x * azimuth.x + nv * azimuth.y * azimuth.y;
    return sqrt(exp_minus_one(-2.0 * log_one_plus(-u.x) / (1.0 + exponent))) * azimuth;
}

#endif
