// Embree 3.13 and 4 behind one face: a query is a ray and, optionally, a filter that sees every hit.
#pragma once

#if KEYLUME_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace engine::embree {

#if KEYLUME_EMBREE_MAJOR >= 4
using QueryContext = RTCRayQueryContext;
inline constexpr RTCSceneFlags kFilterFlag = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
#else
using QueryContext = RTCIntersectContext;
inline constexpr RTCSceneFlags kFilterFlag = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
#endif

/// What a filter finds again behind RTCFilterFunctionNArguments::context.
struct Context {
  QueryContext base;
  void* user = nullptr;
};

inline void* user_of(const RTCFilterFunctionNArguments* arguments) {
  return reinterpret_cast<const Context*>(arguments->context)->user;
}

#if KEYLUME_EMBREE_MAJOR >= 4
template <class Arguments>
Arguments with_filter(Arguments arguments, Context& context, RTCFilterFunctionN filter, void* user) {
  rtcInitRayQueryContext(&context.base);
  context.user = user;
  arguments.context = &context.base;
  arguments.filter = filter;
  if (filter)
    arguments.flags =
        static_cast<RTCRayQueryFlags>(arguments.flags | RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER);
  return arguments;
}

inline void occluded(RTCScene scene, RTCRay& ray, RTCFilterFunctionN filter, void* user) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  Context context;
  arguments = with_filter(arguments, context, filter, user);
  rtcOccluded1(scene, &ray, &arguments);
}

inline void intersect(RTCScene scene, RTCRayHit& ray, RTCFilterFunctionN filter, void* user) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  Context context;
  arguments = with_filter(arguments, context, filter, user);
  rtcIntersect1(scene, &ray, &arguments);
}
#else
inline void set(Context& context, RTCFilterFunctionN filter, void* user) {
  rtcInitIntersectContext(&context.base);
  context.base.filter = filter;
  context.user = user;
}

inline void occluded(RTCScene scene, RTCRay& ray, RTCFilterFunctionN filter, void* user) {
  Context context;
  set(context, filter, user);
  rtcOccluded1(scene, &context.base, &ray);
}

inline void intersect(RTCScene scene, RTCRayHit& ray, RTCFilterFunctionN filter, void* user) {
  Context context;
  set(context, filter, user);
  rtcIntersect1(scene, &context.base, &ray);
}
#endif

}  // namespace engine::embree
