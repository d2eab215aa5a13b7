#include "record/video/video.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include "base/check.h"
#include "files/text.h"

namespace sandlot {
namespace {

std::string what_av_says(int code) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(code, text, sizeof text);
  return text;
}

struct FreeContext {
  void operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
  void operator()(AVFrame* p) const { av_frame_free(&p); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
  void operator()(SwsContext* p) const { sws_freeContext(p); }
  void operator()(AVFormatContext* p) const {
    if (p->pb) avio_closep(&p->pb);
    avformat_free_context(p);
  }
};
template <class T>
using AvOwned = std::unique_ptr<T, FreeContext>;

}  // namespace

struct VideoWriter::Impl {
  VideoOptions options;
  AvOwned<AVFormatContext> format;
  AvOwned<AVCodecContext> encoder;
  AvOwned<AVFrame> frame;
  AvOwned<AVPacket> packet;
  AvOwned<SwsContext> scaler;
  AVStream* stream = nullptr;
  std::uint64_t pictures = 0;

  Error failed(int code) const {
    return Error{"the film cannot be written: " + what_av_says(code),
                 "check the folder and the space on the disk", place_in(options.file)};
  }
  Status open_encoder();
  Status write_packets();
  Status encode(const AVFrame* next);
};

Status VideoWriter::check(const VideoOptions& o) {
  const std::string extension = std::filesystem::path(o.file).extension().string();
  if (extension != ".mp4" && extension != ".mov" && extension != ".mkv")
    return Error{"a film cannot be written as '" + o.file + "'", "call it .mp4, .mov or .mkv"};
  const auto fits = [](int side) { return side >= 16 && side <= 4096 && side % 2 == 0; };
  if (!fits(o.width) || !fits(o.height))
    return Error{
        "a film cannot be " + std::to_string(o.width) + "x" + std::to_string(o.height) + " pixels large",
        "give even numbers from 16 to 4096, such as 1280x720"};
  if (o.rate_hz < 1 || o.rate_hz > 240)
    return Error{"a film cannot have " + std::to_string(o.rate_hz) + " pictures per second", "give 1 to 240"};
  return {};
}

Status VideoWriter::Impl::open_encoder() {
  const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
  if (!codec) codec = avcodec_find_encoder(AV_CODEC_ID_MPEG4);
  if (!codec) return Error{"libavcodec has neither libx264 nor an MPEG-4 encoder here"};
  encoder.reset(avcodec_alloc_context3(codec));
  AVCodecContext& c = *encoder;
  c.width = options.width;
  c.height = options.height;
  c.pix_fmt = AV_PIX_FMT_YUV420P;
  c.time_base = {1, options.rate_hz};
  c.framerate = {options.rate_hz, 1};
  c.gop_size = std::min(250, 2 * options.rate_hz);  // so that one can jump to within two seconds
  c.colorspace = AVCOL_SPC_BT709;
  c.color_primaries = AVCOL_PRI_BT709;
  c.color_trc = AVCOL_TRC_BT709;
  c.color_range = AVCOL_RANGE_MPEG;
  c.thread_count = 1;  // more threads, another film
  c.flags |= AV_CODEC_FLAG_BITEXACT;
  if (format->oformat->flags & AVFMT_GLOBALHEADER) c.flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  if (codec->id == AV_CODEC_ID_H264) {
    av_opt_set(c.priv_data, "preset", "veryfast", 0);
    av_opt_set(c.priv_data, "crf", "20", 0);
  } else {
    c.flags |= AV_CODEC_FLAG_QSCALE;
    c.global_quality = 3 * FF_QP2LAMBDA;
  }
  if (const int code = avcodec_open2(&c, codec, nullptr); code < 0) return failed(code);

  frame.reset(av_frame_alloc());
  frame->format = c.pix_fmt;
  frame->width = c.width;
  frame->height = c.height;
  if (const int code = av_frame_get_buffer(frame.get(), 0); code < 0) return failed(code);
  packet.reset(av_packet_alloc());
  scaler.reset(sws_getContext(c.width, c.height, AV_PIX_FMT_RGB24, c.width, c.height, c.pix_fmt,
                              SWS_BILINEAR | SWS_ACCURATE_RND | SWS_BITEXACT, nullptr, nullptr, nullptr));
  if (!scaler) return failed(AVERROR(ENOMEM));
  const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
  sws_setColorspaceDetails(scaler.get(), bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16);
  return {};
}

Result<VideoWriter> VideoWriter::create(const VideoOptions& options) {
  SL_TRY(check(options));
  av_log_set_level(AV_LOG_QUIET);  // what goes wrong is said by us
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  AVFormatContext* format = nullptr;
  if (const int code = avformat_alloc_output_context2(&format, nullptr, nullptr, options.file.c_str());
      code < 0)
    return impl->failed(code);
  impl->format.reset(format);
  format->flags |= AVFMT_FLAG_BITEXACT;
  SL_TRY(impl->open_encoder());
  impl->stream = avformat_new_stream(format, nullptr);
  if (!impl->stream) return impl->failed(AVERROR(ENOMEM));
  impl->stream->time_base = impl->encoder->time_base;
  impl->stream->avg_frame_rate = impl->encoder->framerate;
  if (const int code = avcodec_parameters_from_context(impl->stream->codecpar, impl->encoder.get()); code < 0)
    return impl->failed(code);
  // "file:", so that a name with a colon is a name and no protocol.
  if (const int code = avio_open(&format->pb, ("file:" + options.file).c_str(), AVIO_FLAG_WRITE); code < 0)
    return impl->failed(code);
  if (const int code = avformat_write_header(format, nullptr); code < 0) return impl->failed(code);
  return VideoWriter(std::move(impl));
}

/// Whatever the encoder has ready goes into the file.
Status VideoWriter::Impl::write_packets() {
  for (;;) {
    int code = avcodec_receive_packet(encoder.get(), packet.get());
    if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return {};
    if (code < 0) return failed(code);
    av_packet_rescale_ts(packet.get(), encoder->time_base, stream->time_base);
    if (packet->duration == 0) packet->duration = av_rescale_q(1, encoder->time_base, stream->time_base);
    packet->stream_index = stream->index;
    code = av_interleaved_write_frame(format.get(), packet.get());
    if (code >= 0) code = format->pb->error;
    if (code < 0) return failed(code);
  }
}

Status VideoWriter::Impl::encode(const AVFrame* next) {
  if (const int code = avcodec_send_frame(encoder.get(), next); code < 0) return failed(code);
  return write_packets();
}

Status VideoWriter::add(std::span<const std::uint8_t> rgb) {
  Impl& s = *impl_;
  const int stride = 3 * s.options.width;
  SL_CHECK(rgb.size() == static_cast<std::size_t>(stride) * static_cast<std::size_t>(s.options.height));
  // The encoder may still hold the last picture's memory.
  if (const int code = av_frame_make_writable(s.frame.get()); code < 0) return s.failed(code);
  const std::uint8_t* const rows[] = {rgb.data()};
  const int strides[] = {stride};
  sws_scale(s.scaler.get(), rows, strides, 0, s.options.height, s.frame->data, s.frame->linesize);
  s.frame->pts = static_cast<std::int64_t>(s.pictures);
  SL_TRY(s.encode(s.frame.get()));
  ++s.pictures;
  return {};
}

Status VideoWriter::finish() {
  Impl& s = *impl_;
  SL_TRY(s.encode(nullptr));
  if (const int code = av_write_trailer(s.format.get()); code < 0) return s.failed(code);
  const int said = s.format->pb->error;
  const int closed = avio_closep(&s.format->pb);
  if (said < 0 || closed < 0) return s.failed(said < 0 ? said : closed);
  return {};
}

std::uint64_t VideoWriter::pictures() const { return impl_->pictures; }
const char* VideoWriter::codec() const { return impl_->encoder->codec->name; }

VideoWriter::VideoWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;
VideoWriter::~VideoWriter() = default;

}  // namespace sandlot
