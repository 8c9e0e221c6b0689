// Values of the throughput weight at the nodes of a quadrature rule over the (u1, u2) square of a technique. A
// workgroup does a few panels, each a rectangle with 8 x 8 Gauss-Legendre nodes; the host sums in double precision.
layout(local_size_x = 64) in;

const uint NODES = 64u;
const uint PANELS_PER_GROUP = 8u; // a group costs the driver as much as half a panel

#ifdef DOUBLE_PRECISION
const float LAST = 0.99999999999999988898; // 1 - 2^-53
#else
const float LAST = ONE_MINUS_EPSILON;
#endif

struct Cell {
    vec4 view; // wo
    uvec4 key;
};

// A technique may map u jump-wise at one value of u1, its split. Panels are given in a coordinate t in [0, 2): the part
// of u1 below the split is t in [0, 1), the part above is [1, 2). Without a split, all of u1 is [1, 2).
struct Panel {
    uvec4 cell;   // x: the cell; y: 1 for the part above the split
    vec4 corner;  // low t within the part, low u2, both widths
};

layout(std430, set = 0, binding = 0) readonly buffer Cells { Cell cells[]; };
layout(std430, set = 0, binding = 1) readonly buffer Parameters { float parameter_values[]; };
layout(std430, set = 0, binding = 2) readonly buffer Panels { Panel panels[]; };
layout(std430, set = 0, binding = 3) readonly buffer Nodes { vec2 nodes[]; };       // in [0, 1]^2
layout(std430, set = 0, binding = 4) writeonly buffer Weights { float weights[]; }; // panel x node; NaN for a bad sample
layout(std430, set = 0, binding = 5) writeonly buffer Splits { float splits[]; };   // one a cell
layout(std430, set = 0, binding = 6) writeonly buffer Done { uint done[]; };        // 1 where every loop of a lane ran to its end

layout(push_constant) uniform Launch { uint count; };

#include "variant/load_parameters.glsl"

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint first = gl_WorkGroupID.x * PANELS_PER_GROUP;
    uint end = min(first + PANELS_PER_GROUP, count);
    for (uint i = first; i < end; i++) {
        Panel panel = panels[i];
        uint cell = panel.cell.x;
        vec3 wo = view_direction(cells[cell].view.xyz);
        load_parameters(cell);

        float split = U1_SPLIT;
        split = split > 0.0 && split < 1.0 ? split : 0.0;
        vec2 u = panel.corner.xy + panel.corner.zw * nodes[lane];
        u.x = panel.cell.y == 1u ? split + (1.0 - split) * u.x : split * u.x;
        DirectionSample s = technique_sample_direction(wo, min(u, vec2(LAST)));
        float weight = throughput_weight(s, wo);
        bool bad = is_nonfinite(weight + (s.pdf + (s.wi.x + s.wi.y + s.wi.z)));
        weights[i * NODES + lane] = bad ? uintBitsToFloat(0x7fc00000u) : weight;
        if (lane == 0u) splits[cell] = split;
    }
    done[gl_GlobalInvocationID.x] = loops_ran(min(gl_NumWorkGroups.x + 1u, 2u)) ? 1u : 0u;
}
