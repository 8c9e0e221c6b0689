// The azimuth frame of a view direction: rotated about the normal so that wo lies in the x-z plane, x >= 0.
#ifndef SAMPLERSCOPE_FRAME
#define SAMPLERSCOPE_FRAME

// (cos, sin) of the azimuth of w; (1, 0) at the normal, where it has none.
vec2 azimuth(vec3 w) {
    float squared = dot(w.xy, w.xy);
    return squared > 0.0 ? w.xy * inversesqrt(squared) : vec2(1.0, 0.0);
}

vec3 to_azimuth_frame(vec3 w, vec2 direction) {
    return vec3(dot(w.xy, direction), direction.x * w.y - direction.y * w.x, w.z);
}

vec3 from_azimuth_frame(vec3 w, vec2 direction) {
    return vec3(direction.x * w.x - direction.y * w.y, direction.y * w.x + direction.x * w.y, w.z);
}

#endif
