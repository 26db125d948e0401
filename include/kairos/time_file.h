// Files that hold pictures over time (.ktime). docs/time.md describes their bytes.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <kairos/export.h>
#include <kairos/flow.h>
#include <kairos/time_picture.h>

namespace kairos {

struct TimeFileOptions {
  double tolerance = TimeQuality().tolerance;  ///< see TimeQuality
  FrameClock clock;
  /// Says from what and how the rendering is made: a part of another one is not continued.
  std::string mark;
  bool objects = false;   ///< keep what each mesh contributes, and how far away it is: TimePicture::objects
  bool geometry = false;  ///< keep where everything is: TimeFile::shot
  bool rays = false;      ///< keep all that rays see, without loss: TimeFile::replay
  /// Into how many equal parts the shot's time is cut, each of which is recorded by itself, from a shot of its own
  /// (TimeFileWriter::begin_slab), and within the tolerance of its own time: so may a file hold many frames.
  int slabs = 1;
};

/// Writes what pixels show over time, tile by tile as they are complete, to PATH.part; finish() makes PATH of it. What
/// ends in between, by whatever means, leaves the finished tiles behind, and a writer of the same rendering goes on
/// with them. The file has the same bytes for any number of threads and interruptions.
class KAIROS_API TimeFileWriter : public PixelConsumer {
 public:
  /// Throws Error(bad_usage) like TimeFilm; Error(io) when the file cannot be written or somebody else is writing it;
  /// Error(bad_input) when PATH.part is there, but of another rendering.
  TimeFileWriter(const std::string& path, const Shot& shot, const RenderParams& params,
                 const TimeFileOptions& options = {});
  /// Leaves PATH.part unless finish() was called.
  ~TimeFileWriter() override;
  TimeFileWriter(const TimeFileWriter&) = delete;
  TimeFileWriter& operator=(const TimeFileWriter&) = delete;

  RecordNeeds needs() const override;
  bool has(int x, int y) const override;
  void add(const PixelRecord& record) override;

  /// From here on, records are those of shots of this slab, whose time is one of the equal parts of all of the time: at
  /// the beginning, slab 0. Not while another one is being rendered. With the same seed, rays of all slabs are the
  /// same.
  void begin_slab(int slab);
  /// Did an earlier writer leave all of it?
  bool slab_is_there(int slab) const;

  size_t tiles() const;         ///< of all slabs
  size_t tiles_before() const;  ///< of them, those that an earlier writer left

  /// Puts the tiles in order. Throws Error(io), and Error(bad_usage) where pixels are missing.
  void finish();
  /// In place of finish(): makes PATH of the tiles that are there, for merge_time_files. Throws Error(io).
  void finish_part();

  /// Pixels: the side of a tile, counted from the upper left pixel that is held. Who renders a part of a picture
  /// renders whole tiles; a tile of which a pixel is missing is not kept.
  static constexpr int kTileSide = 32;

 private:
  class File;
  RecordNeeds needs_;
  std::unique_ptr<File> file_;
};

/// What a file says of itself.
struct TimeFileInfo {
  uint64_t bytes = 0;
  int slabs = 1;                        ///< TimeFileOptions::slabs
  uint64_t tiles = 0, tiles_there = 0;  ///< of all slabs
  bool finished = true;                 ///< false: a part, which rendering has not come to the end of
  std::string mark;                     ///< TimeFileOptions::mark
};

/// Reads such a file, or the part of one. Tiles are read when they are first needed, and kept.
class KAIROS_API TimeFile {
 public:
  /// Throws Error(io) when it cannot be read, Error(bad_input) for another kind of file and a damaged one. `picture`
  /// throws these too, for tiles that turn out to be damaged. kept_bytes: of unpacked tiles, which are kept for what is
  /// exposed next; who exposes once is faster with 0.
  static TimeFile open(const std::string& path, uint64_t kept_bytes = uint64_t{4} << 30);

  const TimeFileInfo& info() const { return info_; }
  const TimePicture& picture() const { return picture_; }

  /// The picture under a shutter, whose times are counted from the frame's time. Throws Error(bad_usage) as Exposure
  /// does, for one that leaves the recorded time, too; and what `picture().expose` does.
  Image expose(const Shutter& shutter, const ExposeOptions& options = {}) const;
  /// What is seen at an instant, in seconds from the frame's time: see TimePicture::at. Throws Error(bad_usage) for one
  /// that is not recorded.
  Image at(double seconds, const ExposeOptions& options = {}) const;
  /// A pixel's pieces: TimePicture::signal.
  std::vector<TimePiece> signal(int x, int y) const { return picture_.signal(x, y); }
  /// Where what each pixel's centre shows at `from` is at `to`, which may be the earlier one: see kairos::flow. Seconds
  /// from the frame's time. Of all of the frame, whatever the crop. FlowOptions::backward and times count from the
  /// earlier one to the later one. Throws what `shot` and kairos::flow do.
  Image flow(double from, double to, FlowOptions options = {}) const;

  bool has_geometry() const;
  /// Where everything is while the picture's shutter is open, from scene time `from` to `to`: what was rendered,
  /// without what surfaces look like, and without what blends. Cut-outs are whole. For `flow`, and for poses of the
  /// camera. Throws Error(bad_usage) where there is no geometry, and for times that are not in order or not recorded;
  /// Error(bad_input) where it is damaged.
  Shot shot(double from, double to) const;

  bool has_rays() const;
  /// Hands over the records of a slab (TimeFileOptions::slabs) as rendering handed them over, from one thread, tile by
  /// tile: a Picture under any weight, or any other consumer, gets what it would have got then, but for normals and
  /// albedo. Throws Error(bad_usage) where rays are not held, for another slab, and for a consumer that needs surfaces;
  /// what `picture` throws; Error(cancelled) when `progress` says so.
  void replay(PixelConsumer& consumer, int slab = 0, const std::function<bool(double fraction)>& progress = {}) const;

  /// Reads all of the file. Throws Error(bad_input) that names the first tile that is damaged.
  void check() const;

 private:
  class Tiles;
  TimeFile(TimeFileInfo info, TimePicture picture, std::shared_ptr<Tiles> tiles, std::string path)
      : info_(info), picture_(std::move(picture)), tiles_(std::move(tiles)), path_(std::move(path)) {}

  TimeFileInfo info_;
  TimePicture picture_;
  std::shared_ptr<Tiles> tiles_;
  std::string path_;
};

/// Makes `path` of parts of a picture (TimeFileWriter::finish_part): the bytes that one writer gives. Throws
/// Error(bad_input) where one is of another rendering or damaged, a tile is missing, or there twice; Error(io).
KAIROS_API void merge_time_files(const std::vector<std::string>& parts, const std::string& path);

}  // namespace kairos
