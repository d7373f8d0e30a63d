#include "adaptive_grid_stereo/simulation/scene.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

#include <embree3/rtcore.h>
#include <Eigen/Geometry>

namespace adaptive_grid_stereo {
namespace simulation {
namespace {

struct alignas(32) Mask {
  int lanes[RayBundle::kSize];
};

void fill(const RayBundle& rays, float far, Mask* valid, RTCRay8* query) {
  for (int i = 0; i < RayBundle::kSize; ++i) {
    const bool used = i < rays.count;
    const Eigen::Vector3f origin = used ? rays.origins[i] : Eigen::Vector3f::Zero();
    const Eigen::Vector3f direction = used ? rays.directions[i] : Eigen::Vector3f::UnitX();
    valid->lanes[i] = used ? -1 : 0;
    query->org_x[i] = origin.x();
    query->org_y[i] = origin.y();
    query->org_z[i] = origin.z();
    query->dir_x[i] = direction.x();
    query->dir_y[i] = direction.y();
    query->dir_z[i] = direction.z();
    query->tnear[i] = 0.0f;
    query->tfar[i] = far;
    query->time[i] = 0.0f;
    query->mask[i] = 0xffffffffu;
    query->id[i] = 0;
    query->flags[i] = 0;
  }
}

}  // namespace

struct Scene::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<Mesh> meshes;  // index: Embree's geometry id

  ~Impl() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  void attach(const Mesh& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             sizeof(Eigen::Vector3f), mesh.vertices.size());
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              sizeof(mesh.triangles[0]), mesh.triangles.size());
    if (vertices != nullptr && triangles != nullptr) {
      std::memcpy(vertices, mesh.vertices.data(), sizeof(Eigen::Vector3f) * mesh.vertices.size());
      std::memcpy(triangles, mesh.triangles.data(),
                  sizeof(mesh.triangles[0]) * mesh.triangles.size());
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }

  // `facet` is the triangle's normal, of any length and on any side.
  SurfacePoint pointAt(unsigned geometry, unsigned triangle, float u, float v, float distance,
                       const Eigen::Vector3f& facet, const Eigen::Vector3f& origin,
                       const Eigen::Vector3f& direction) const {
    const Mesh& mesh = meshes[geometry];
    SurfacePoint point;
    point.distance = distance;
    point.position = origin + distance * direction;
    point.material = mesh.material;
    Eigen::Vector3f normal = facet.dot(direction) > 0.0f ? Eigen::Vector3f(-facet) : facet;
    if (!mesh.normals.empty()) {
      const auto& corners = mesh.triangles[triangle];
      const Eigen::Vector3f smooth = (1.0f - u - v) * mesh.normals[corners[0]] +
                                     u * mesh.normals[corners[1]] + v * mesh.normals[corners[2]];
      normal = smooth.dot(normal) < 0.0f ? Eigen::Vector3f(-smooth) : smooth;
    }
    point.normal = normal.normalized();
    return point;
  }
};

Scene::Scene(std::vector<Mesh> meshes) : impl_(std::make_unique<Impl>()) {
  impl_->device = rtcNewDevice(nullptr);
  if (impl_->device == nullptr) throw std::runtime_error("Embree: no device");
  impl_->scene = rtcNewScene(impl_->device);
  // Robust: no ray slips through between two triangles.
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  for (Mesh& mesh : meshes) {
    if (mesh.triangles.empty()) continue;
    impl_->attach(mesh);
    impl_->meshes.push_back(std::move(mesh));
  }
  rtcCommitScene(impl_->scene);
  const RTCError error = rtcGetDeviceError(impl_->device);
  if (error != RTC_ERROR_NONE) {
    throw std::runtime_error("Embree: the scene could not be built, error " +
                             std::to_string(static_cast<int>(error)));
  }
}

Scene::~Scene() = default;

bool Scene::intersect(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                      SurfacePoint* point) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  RTCRayHit query{};
  query.ray.org_x = origin.x();
  query.ray.org_y = origin.y();
  query.ray.org_z = origin.z();
  query.ray.dir_x = direction.x();
  query.ray.dir_y = direction.y();
  query.ray.dir_z = direction.z();
  query.ray.tfar = std::numeric_limits<float>::infinity();
  query.ray.mask = 0xffffffffu;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;

  *point =
      impl_->pointAt(query.hit.geomID, query.hit.primID, query.hit.u, query.hit.v, query.ray.tfar,
                     {query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z}, origin, direction);
  return true;
}

void Scene::intersect(const RayBundle& rays, std::array<SurfacePoint, RayBundle::kSize>* points,
                      std::array<bool, RayBundle::kSize>* hits) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  Mask valid;
  RTCRayHit8 query;
  fill(rays, std::numeric_limits<float>::infinity(), &valid, &query.ray);
  std::fill_n(query.hit.geomID, RayBundle::kSize, RTC_INVALID_GEOMETRY_ID);
  rtcIntersect8(valid.lanes, impl_->scene, &context, &query);
  for (int i = 0; i < rays.count; ++i) {
    (*hits)[i] = query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    if (!(*hits)[i]) continue;
    (*points)[i] =
        impl_->pointAt(query.hit.geomID[i], query.hit.primID[i], query.hit.u[i], query.hit.v[i],
                       query.ray.tfar[i], {query.hit.Ng_x[i], query.hit.Ng_y[i], query.hit.Ng_z[i]},
                       rays.origins[i], rays.directions[i]);
  }
}

void Scene::occluded(const RayBundle& rays, float far,
                     std::array<bool, RayBundle::kSize>* hits) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  Mask valid;
  RTCRay8 query;
  fill(rays, far, &valid, &query);
  rtcOccluded8(valid.lanes, impl_->scene, &context, &query);
  for (int i = 0; i < rays.count; ++i) (*hits)[i] = query.tfar[i] < 0.0f;
}

bool Scene::occluded(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near,
                     float far) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tnear = near;
  ray.tfar = far;
  ray.mask = 0xffffffffu;
  rtcOccluded1(impl_->scene, &context, &ray);
  return ray.tfar < 0.0f;  // Embree's mark for a hit: minus infinity
}

}  // namespace simulation
}  // namespace adaptive_grid_stereo
