// What every job may leave out, as specialization constants: everything is kept unless one says otherwise.
#ifndef SAMPLERSCOPE_STRUCTURE
#define SAMPLERSCOPE_STRUCTURE

layout(constant_id = 8) const bool HORIZON_TEST = true; // off for techniques that draw nothing below the horizon
layout(constant_id = 9) const bool VIEW_AZIMUTH = true; // off where every view lies in the x-z plane

vec3 view_direction(vec3 wo) {
    return VIEW_AZIMUTH ? wo : vec3(wo.x, 0.0, wo.z);
}

#endif
