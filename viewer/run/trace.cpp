#include "viewer/run/trace.h"

#include <iomanip>
#include <utility>

namespace meshfront {

Result<TraceWriter> TraceWriter::create(const std::filesystem::path& path) {
  std::ofstream out(path, std::ios::trunc);
  if (!out) return fail(ErrorCode::unavailable, "cannot write the trace " + path.string());
  out.imbue(std::locale::classic());
  out << "seconds,requests,records,bytes_up,bytes_down,triangles,visible_candidates,psnr\n";
  return TraceWriter(path, std::move(out));
}

void TraceWriter::write(const TraceRow& row) {
  out_ << std::fixed << std::setprecision(4) << row.seconds << ',' << row.requests << ','
       << row.records << ',' << row.bytesUp << ',' << row.bytesDown << ',' << row.triangles << ','
       << row.visibleCandidates << ',';
  if (row.psnr) out_ << std::setprecision(3) << *row.psnr;
  out_ << '\n';
  out_.flush();  // a killed run leaves what it had
}

Result<void> TraceWriter::close() {
  out_.close();
  if (out_.fail()) return fail(ErrorCode::unavailable, "cannot write the trace " + path_.string());
  return {};
}

}  // namespace meshfront
