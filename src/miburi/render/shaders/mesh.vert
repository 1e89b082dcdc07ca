#version 330 core
// Names of attributes, uniforms and macros are pyrender's. Normals are those of shapes whose pose scales them equally
// in the directions in which their normals point, so the pose itself turns them.
layout(location = 0) in vec3 position;
#ifdef NORMAL_LOC
layout(location = NORMAL_LOC) in vec3 normal;
out vec3 seen_normal;
#endif
layout(location = COLOR_0_LOC) in vec4 color_0;
layout(location = INST_M_LOC) in mat4 inst_m;
uniform mat4 M;
uniform mat4 V;
uniform mat4 P;
out vec3 seen_position;
out vec3 colour;

void main()
{
    vec4 seen = V * (M * (inst_m * vec4(position, 1.0)));
    gl_Position = P * seen;
    seen_position = seen.xyz;
    colour = color_0.rgb;
#ifdef NORMAL_LOC
    seen_normal = mat3(V) * (mat3(M) * (mat3(inst_m) * normal));
#endif
}
