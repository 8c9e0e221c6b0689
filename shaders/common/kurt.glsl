// The specular lobe of Kurt et al. 2010 (eq. 10).
#ifndef SAMPLERSCOPE_KURT
#define SAMPLERSCOPE_KURT

#include "common/beckmann.glsl"

// reflectance D/(4 wo.h (ci co)^alpha). 0 where a cosine is not positive.
float kurt_lobe(HalfVector h, float ci, float co, float reflectance, float mx, float my, float alpha) {
    float shadowing = alpha > 0.0 ? -alpha * (log(ci) + log(co)) : 0.0;
    float x = beckmann_exponent(h, mx, my) + shadowing;
    float f = exponential_ratio(reflectance, 0.25 * beckmann_scale(h, mx, my), x, h.to_view, 1.0);
    return ci > 0.0 && co > 0.0 ? f : 0.0;
}

#endif
