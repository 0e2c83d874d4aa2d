#include "server/bench/speed/speed_rows.h"

namespace graspdb {

Json EncodeSpeedRow(const SpeedRow& row) {
  Json json;
  json["name"] = row.name;
  json["triangles"] = row.triangles ? Json(*row.triangles) : Json();
  json["seconds"] = EncodeTiming(row.timing);
  json["library"] = Json();
  if (row.library) {
    json["library"] = {
        {"call", row.library->call},
        {"seconds", EncodeTiming(row.library->timing)},
        {"times", CalcMedian(row.library->timing) / CalcMedian(row.timing)}};
  }
  json["goal"] = row.goal ? Json(*row.goal) : Json();
  return json;
}

Json EncodeSpeedRows(const std::vector<SpeedRow>& rows) {
  Json json = Json::array();
  for (const SpeedRow& row : rows) json.push_back(EncodeSpeedRow(row));
  return json;
}

Json EncodeGrowthCurve(const GrowthCurve& curve) {
  return {{"name", curve.name},
          {"x_label", curve.x_label},
          {"y_label", curve.y_label},
          {"x", curve.x},
          {"y", curve.y}};
}

}  // namespace graspdb
