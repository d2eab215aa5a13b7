#include <csetjmp>
#include <cstdio>
// libjpeg's header needs FILE first.
#include <jpeglib.h>

#include "assets/image/decoders.h"

namespace sandlot::assets::image {
namespace {

/// Progressive files may hold any number of scans, each as expensive as the whole image.
constexpr int max_scans = 200;

struct Job {
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  jpeg_decompress_struct jpeg{};
  std::jmp_buf back{};
  std::string problem;
  std::vector<JSAMPLE> pixels;
};
Job& job_of(j_common_ptr jpeg) { return *static_cast<Job*>(jpeg->client_data); }

[[noreturn]] void give_up(j_common_ptr jpeg) {
  Job& job = job_of(jpeg);
  if (job.problem.empty()) {
    char text[JMSG_LENGTH_MAX] = {};
    jpeg->err->format_message(jpeg, text);
    job.problem = std::string("is damaged: ") + text;
  }
  std::longjmp(job.back, 1);  // NOLINT(cert-err52-cpp): libjpeg knows no other way
}
/// Warnings stand for repaired damage, such as half a terrain: they are errors here.
void on_message(j_common_ptr jpeg, int level) {
  if (level < 0) give_up(jpeg);
}
void on_print(j_common_ptr) {}
void on_progress(j_common_ptr jpeg) {
  if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number > max_scans) {
    job_of(jpeg).problem = "has too many scans";
    std::longjmp(job_of(jpeg).back, 1);  // NOLINT(cert-err52-cpp)
  }
}

/// Up to the size; false when libjpeg gave up.
bool read_header(Job& job, std::string_view bytes) {
  if (setjmp(job.back)) return false;  // NOLINT(cert-err52-cpp)
  jpeg_create_decompress(&job.jpeg);
  job.jpeg.progress = &job.progress;
  job.jpeg.mem->max_memory_to_use = 512L << 20;
  jpeg_mem_src(&job.jpeg, reinterpret_cast<const unsigned char*>(bytes.data()),
               static_cast<unsigned long>(bytes.size()));
  jpeg_read_header(&job.jpeg, TRUE);
  return true;
}

bool read_pixels(Job& job) {
  if (setjmp(job.back)) return false;  // NOLINT(cert-err52-cpp)
  job.jpeg.dct_method = JDCT_ISLOW;    // the same bits with and without vector instructions
  jpeg_start_decompress(&job.jpeg);
  while (job.jpeg.output_scanline < job.jpeg.output_height) {
    JSAMPROW row = job.pixels.data() + std::size_t{job.jpeg.output_scanline} * job.jpeg.output_width *
                                           static_cast<std::size_t>(job.jpeg.output_components);
    jpeg_read_scanlines(&job.jpeg, &row, 1);
  }
  jpeg_finish_decompress(&job.jpeg);
  return true;
}

}  // namespace

std::string decode_jpeg(std::string_view bytes, const ImageLimits& limits, Image& out) {
  Job job;
  job.jpeg.client_data = &job;
  job.jpeg.err = jpeg_std_error(&job.errors);
  job.errors.error_exit = give_up;
  job.errors.emit_message = on_message;
  job.errors.output_message = on_print;
  job.progress.progress_monitor = on_progress;
  bool good = read_header(job, bytes);
  std::string problem;
  if (good) {
    problem = judge_size(job.jpeg.image_width, job.jpeg.image_height, limits);
    const bool grey = job.jpeg.num_components == 1;
    if (problem.empty() && !grey && job.jpeg.num_components != 3)
      problem = "is a JPEG with " + std::to_string(job.jpeg.num_components) +
                " colour channels, not grey or RGB";
    if (problem.empty()) {
      job.jpeg.out_color_space = grey ? JCS_GRAYSCALE : JCS_RGB;
      out.width = static_cast<int>(job.jpeg.image_width);
      out.height = static_cast<int>(job.jpeg.image_height);
      out.channels = grey ? 1 : 3;
      job.pixels.resize(std::size_t{job.jpeg.image_width} * job.jpeg.image_height *
                        static_cast<std::size_t>(out.channels));
      good = read_pixels(job);
    }
  }
  if (!good) problem = job.problem;
  jpeg_destroy_decompress(&job.jpeg);
  if (problem.empty()) out.data.assign(job.pixels.begin(), job.pixels.end());
  return problem;
}

}  // namespace sandlot::assets::image
