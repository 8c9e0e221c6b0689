// The anisotropic Beckmann distribution of half vectors, with its sampling.
// Source: Kurt, Szirmay-Kalos, Krivanek, "An Anisotropic BRDF Model for Fitting and Monte Carlo Rendering" (2010),
// eq. 4, 5 and 16 to 20.
#ifndef SAMPLERSCOPE_BECKMANN
#define SAMPLERSCOPE_BECKMANN

#include "common/circle.glsl"
#include "common/half-vector.glsl"
#include "common/logarithm.glsl"

// log q of eq. 4: -tan^2(theta_h) (cos^2 phi_h/mx^2 + sin^2 phi_h/my^2).
float beckmann_exponent(HalfVector h, float mx, float my) {
    vec2 scaled = h.slope / vec2(mx, my);
    return -dot(scaled, scaled);
}

// D of eq. 5 over q: 1/(pi mx my cos^4). The integral of D with the cosine is 1. Where tan^2 is cut, q is below e^-1e4.
float beckmann_scale(HalfVector h, float mx, float my) {
    float secant2 = 1.0 + min(h.tangent2, 1.0e6);
    return secant2 * secant2 / (PI * mx * my);
}

// share times the density of wi (eq. 20). A tiny share of a mixture may be all that makes a density fit in float32.
float beckmann_density(float share, HalfVector h, float mx, float my) {
    return reflected_density(share, beckmann_scale(h, mx, my) * h.cosine, beckmann_exponent(h, mx, my), h);
}

// Slope of a half vector with density D cos (eq. 16 to 19). Written with slopes, the two arc tangents and the quadrant
// they need go away: both components are Gaussian.
vec2 beckmann_slope(vec2 u, float mx, float my) {
    return sqrt(-log_one_plus(-u.x)) * vec2(mx, my) * point_on_circle(u.y);
}

#endif
