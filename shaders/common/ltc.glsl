// Linearly transformed cosines (Heitz et al. 2016) for the EON model: M = [a 0 b; 0 c 0; d 0 1] acts on a cosine lobe in
// the azimuth frame of wo. Source of the coefficients: Portsmouth, Kutz, Hill 2024 (EON), Listing 2.
#ifndef SAMPLERSCOPE_LTC
#define SAMPLERSCOPE_LTC

#include "common/circle.glsl"

struct LtcLobe {
    float a;
    float b;
    float c;
    float d;
    float determinant;
    float inverse_determinant; // once a view, in place of a division a sample
};

LtcLobe ltc_lobe(float a, float b, float c, float d) {
    float determinant = c * (a - b * d);
    return LtcLobe(a, b, c, d, determinant, 1.0 / determinant);
}

// The fit of Listing 2 at view cosine mu and roughness r. d is expanded in e = 1 - mu, which is exact near normal
// incidence: there both polynomials of the printed form nearly vanish and float32 loses the ratio. d changes sign at
// theta_o = 0.7755 degrees: positive closer to the normal, negative beyond.
LtcLobe eon_lobe(float mu, float r) {
    float e = 1.0 - mu;
    float a = 1.0 + r * (0.303392 + (-0.518982 + 0.111709 * mu) * mu + (-0.276266 + 0.335918 * mu) * r);
    float b = r * (-1.16407 + 1.15859 * mu + (0.150815 - 0.150105 * mu) * r) / (mu * mu * mu - 1.43545);
    float c = 1.0 + (0.20013 + (-0.506373 + 0.261777 * mu) * mu) * r;
    float d = r * (-0.000006 + (0.065466 + 0.475392 * e) * e) / (-0.0017372 + (-2.0725628 + e) * e);
    return ltc_lobe(a, b, c, d);
}

// The same fit with d = 0: no direction leaves the hemisphere.
LtcLobe eon_lobe_nonnegative(float mu, float r) {
    LtcLobe lobe = eon_lobe(mu, r);
    return ltc_lobe(lobe.a, lobe.b, lobe.c, 0.0);
}

// Density per steradian of w, on the whole sphere: eq. 23 and 24 with M^-1 written by its adjugate.
float ltc_density(LtcLobe lobe, vec3 w) {
    vec3 h = vec3(lobe.c * (w.x - lobe.b * w.z),
                  (lobe.a - lobe.b * lobe.d) * w.y,
                  lobe.c * (lobe.a * w.z - lobe.d * w.x));
    float squared = dot(h, h);
    float ratio = lobe.determinant / squared;
    return h.z > 0.0 ? INV_PI * ratio * ratio * h.z : 0.0;
}

// The direction of w = M h and its density, where h was drawn from the cosine lobe with density pdf.
DirectionSample ltc_normalised(LtcLobe lobe, vec3 w, float pdf) {
    float squared = dot(w, w);
    float length = sqrt(squared);
    return DirectionSample(w * (1.0 / length), pdf * squared * length * lobe.inverse_determinant);
}

// u1 is the squared cosine of the untransformed direction: the density's zero, and with it the weight's tail, lies at
// u1 = 0, where random numbers are dense.
DirectionSample ltc_sample(LtcLobe lobe, vec2 u) {
    float cosine = sqrt(u.x);
    vec2 p = sqrt(1.0 - u.x) * point_on_circle(u.y);
    vec3 w = vec3(lobe.a * p.x + lobe.b * cosine, lobe.c * p.y, lobe.d * p.x + cosine);
    return ltc_normalised(lobe, w, INV_PI * cosine);
}

// Clipped LTC (section 3.1): the untransformed direction comes from the part of the cosine hemisphere that maps above
// the horizon. Its projection is a half disk and, on the side that the sign of d clips, a half ellipse of semi-axis
// 1/sqrt(1 + d^2). The area of both, in units of pi, is 1 - cltc_clipped.
float cltc_clipped(LtcLobe lobe) {
    float squared = lobe.d * lobe.d;
    float root = sqrt(1.0 + squared);
    return 0.5 * squared / (root * (root + 1.0));
}

float cltc_density(LtcLobe lobe, vec3 w) {
    return w.z > 0.0 ? ltc_density(lobe, w) * (1.0 / (1.0 - cltc_clipped(lobe))) : 0.0;
}

// The disk point (x0, y), x0^2 + y^2 = 1 - u1, is squeezed along x into half disk (x > 0) and half ellipse (x < 0). Both
// cosines, of the untransformed direction and of the transformed one, are products that do not cancel at their zeros:
// with q^2 = 1 - y^2 = x0^2 + u1, (q - x0)(q + x0) = u1 exactly.
DirectionSample cltc_sample(LtcLobe lobe, vec2 u) {
    float clipped = cltc_clipped(lobe);
    float area = 1.0 - clipped;
    float root = sqrt(1.0 + lobe.d * lobe.d);
    vec2 disk = sqrt(1.0 - u.x) * point_on_circle(u.y);
    float q = sqrt(disk.x * disk.x + u.x);
    float far = q + abs(disk.x);
    float near = far > 0.0 ? u.x / far : 0.0;
    bool inner = disk.x > 0.0;
    float below = inner ? near : far;  // q - x0
    float above = inner ? far : near;  // q + x0
    float x = q * clipped + area * disk.x;
    float cosine = sqrt(area * below * (2.0 * q * clipped + area * above));
    float sum = cosine + abs(lobe.d * x);
    float difference = sum > 0.0 ? 0.5 * (root + 1.0) * above * (q + root * abs(x)) / sum : 0.0;
    float z = x < 0.0 ? difference : sum; // cosine + |d| x
    float hx = lobe.d > 0.0 ? x : -x;
    vec3 w = vec3(lobe.a * hx + lobe.b * cosine, lobe.c * disk.y, z);
    return ltc_normalised(lobe, w, cosine * (INV_PI / area));
}

#endif
