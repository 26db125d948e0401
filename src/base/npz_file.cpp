#include "base/npz_file.h"

#include <utility>

#include "base/crc32.h"

namespace kairos {

namespace {

constexpr uint32_t kNoSize = 0xffffffffu;  // of 32 bits: the real one stands in the ZIP64 fields
constexpr uint16_t kZip64 = 1, kVersion = 45, kStored = 0;
/// For which an array's file has room beside any shape: those of structures with many fields get twice the room.
constexpr size_t kLongestDescr = 64;
constexpr uint16_t kFirstDay = 0x21;  // 1 January 1980, the earliest there is: files of the same content are the same

}  // namespace

std::string npy_header(const std::string& descr, std::span<const uint64_t> shape) {
  std::string sizes;
  for (const uint64_t size : shape) sizes += std::to_string(size) + (shape.size() == 1 ? "," : ", ");
  if (shape.size() > 1) sizes.resize(sizes.size() - 2);
  std::string text = "{'descr': " + descr + ", 'fortran_order': False, 'shape': (" + sizes + "), }";
  constexpr size_t kPreamble = 10;  // magic, version, length of the rest of the header
  text.resize((descr.size() <= kLongestDescr ? kNpyHeader : 2 * kNpyHeader) - kPreamble - 1, ' ');
  text += '\n';
  const std::string length{static_cast<char>(text.size()), 0};
  return std::string("\x93NUMPY\x01\x00", 8) + length + text;
}

std::string npy_header(const std::string& descr, uint64_t count, uint64_t width) {
  const uint64_t one[] = {count}, two[] = {width == 0 ? 0 : count / width, width};
  return width == 0 ? npy_header(descr, one) : npy_header(descr, two);
}

void NpzFile::add(const std::string& name, uint64_t size, uint32_t crc,
                  const std::function<void(AtomicFile& out)>& body) {
  const uint64_t offset = file_.tell();
  bytes_.clear();
  put_little(bytes_, uint32_t{0x04034b50});
  put_common(name, crc, 20);
  put_name(name);
  put_sizes(size, nullptr);
  write();
  body(file_);
  members_.push_back({name, size, offset, crc});
}

void NpzFile::add_array(const std::string& name, const std::string& descr, std::span<const uint64_t> shape,
                        std::span<const uint8_t> bytes) {
  const std::string header = npy_header(descr, shape);
  Crc32 crc;
  crc.add(header.data(), header.size());
  crc.add(bytes.data(), bytes.size());
  add(name + ".npy", header.size() + bytes.size(), crc.value(), [&](AtomicFile& out) {
    out.write(header.data(), header.size());
    out.write(bytes.data(), bytes.size());
  });
}

void NpzFile::finish() {
  const uint64_t directory = file_.tell();
  for (const Member& member : members_) {
    bytes_.clear();
    put_little(bytes_, uint32_t{0x02014b50});
    put_little(bytes_, kVersion);
    put_common(member.name, member.crc, 28);
    for (int i = 0; i < 3; ++i) put_little(bytes_, uint16_t{0});  // comment, disk, internal attributes
    put_little(bytes_, uint32_t{0});                              // external attributes
    put_little(bytes_, kNoSize);                                  // where it lies
    put_name(member.name);
    put_sizes(member.size, &member.offset);
    write();
  }
  const uint64_t end = file_.tell();
  bytes_.clear();
  put_little(bytes_, uint32_t{0x06064b50});
  put_little(bytes_, uint64_t{44});  // bytes that follow
  put_little(bytes_, kVersion);
  put_little(bytes_, kVersion);
  put_little(bytes_, uint64_t{0});  // disks
  put_little(bytes_, uint64_t{members_.size()});
  put_little(bytes_, uint64_t{members_.size()});
  put_little(bytes_, end - directory);
  put_little(bytes_, directory);
  put_little(bytes_, uint32_t{0x07064b50});
  put_little(bytes_, uint32_t{0});
  put_little(bytes_, end);
  put_little(bytes_, uint32_t{1});
  put_little(bytes_, uint32_t{0x06054b50});
  put_little(bytes_, uint32_t{0});
  put_little(bytes_, static_cast<uint16_t>(members_.size()));
  put_little(bytes_, static_cast<uint16_t>(members_.size()));
  put_little(bytes_, kNoSize);
  put_little(bytes_, kNoSize);
  put_little(bytes_, uint16_t{0});
  write();
  file_.commit();
}

void NpzFile::put_common(const std::string& name, uint32_t crc, uint16_t extra) {
  for (const uint16_t value : {kVersion, uint16_t{0}, kStored, uint16_t{0}, kFirstDay}) put_little(bytes_, value);
  put_little(bytes_, crc);
  put_little(bytes_, kNoSize);
  put_little(bytes_, kNoSize);
  put_little(bytes_, static_cast<uint16_t>(name.size()));
  put_little(bytes_, extra);
}

void NpzFile::put_sizes(uint64_t size, const uint64_t* offset) {
  put_little(bytes_, kZip64);
  put_little(bytes_, static_cast<uint16_t>(offset != nullptr ? 24 : 16));
  put_little(bytes_, size);
  put_little(bytes_, size);
  if (offset != nullptr) put_little(bytes_, *offset);
}

NpyFile::NpyFile(const std::string& path, std::string descr, uint64_t width)
    : file_(path), descr_(std::move(descr)), width_(width) {
  write_header();
}

void NpyFile::write(std::span<const uint8_t> bytes, uint64_t items) {
  file_.write(bytes.data(), bytes.size());
  count_ += items;
}

void NpyFile::finish() {
  file_.seek(0);
  write_header();
  file_.commit();
}

void NpyFile::write_header() {
  const std::string header = npy_header(descr_, count_, width_);
  file_.write(header.data(), header.size());
}

NpyColumn::NpyColumn(const std::string& path, std::string name, std::string descr, uint64_t width)
    : file_(path), name_(std::move(name)), descr_(std::move(descr)), width_(width) {}

void NpyColumn::flush() {
  file_.write(bytes_.data(), bytes_.size());
  size_ += bytes_.size();
  bytes_.clear();
}

// The checksum begins with the header, which is known last: what follows is read once more for it.
void NpyColumn::add_to(NpzFile& npz) {
  flush();
  const std::string header = npy_header(descr_, count_, width_);
  Crc32 crc;
  crc.add(header.data(), header.size());
  file_.read([&](const char* block, size_t size) { crc.add(block, size); });
  npz.add(name_ + ".npy", kNpyHeader + size_, crc.value(), [&](AtomicFile& out) {
    out.write(header.data(), header.size());
    file_.read([&](const char* block, size_t size) { out.write(block, size); });
  });
}

}  // namespace kairos
