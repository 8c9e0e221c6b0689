// The specular lobe of Kurt et al. 2010 (eq. 10).
#ifndef SAMPLERSCOPE_KURT
#define SAMPLERSCOPE_KURT

#include "common/beckmann.glsl"

// F D/(4 wo.h (ci co)^alpha); `fresnel` is F. The caller sees to it that both cosines are positive.
float kurt_lobe(HalfVector h, float cosines, float fresnel, float mx, float my, float alpha) {
    return fresnel * beckmann(h, mx, my) / (4.0 * h.to_view * pow(cosines, alpha));
}

#endif
