#include "viewer/run/flight_log.h"

#include <iomanip>
#include <utility>

namespace meshfront {

Result<FlightLog> FlightLog::create(const std::filesystem::path& path) {
  std::ofstream out(path, std::ios::trunc);
  if (!out) return fail(ErrorCode::unavailable, "cannot write the flight's log " + path.string());
  out.imbue(std::locale::classic());
  out << "frame,time,bytes_down,bytes_up,splits,triangles,psnr,state,collapses,resplits,memory,"
         "final_share\n";
  return FlightLog(path, std::move(out));
}

void FlightLog::write(const FlightRow& row) {
  out_ << row.frame << ',' << std::fixed << std::setprecision(4) << row.time << ',' << row.bytesDown
       << ',' << row.bytesUp << ',' << row.splits << ',' << row.triangles << ',';
  if (row.psnr) out_ << std::setprecision(3) << *row.psnr;
  out_ << ',' << row.state << ',' << row.collapses << ',' << row.resplits << ',' << row.memory
       << ',' << std::setprecision(4) << row.finalShare << '\n';
  out_.flush();  // a killed run leaves what it had
}

Result<void> FlightLog::close() {
  out_.close();
  if (out_.fail())
    return fail(ErrorCode::unavailable, "cannot write the flight's log " + path_.string());
  return {};
}

}  // namespace meshfront
