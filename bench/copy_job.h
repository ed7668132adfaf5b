// Memory to be copied: what a bulk builder reads, and the planes it writes.
#ifndef HALFSPACE_BENCH_COPY_JOB_H_
#define HALFSPACE_BENCH_COPY_JOB_H_

#include <array>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace halfspace::bench {

// Arrays of different lengths that are walked over together: every one is cut
// into the same number of parts, and part i of one describes the same objects
// as part i of another.
template <typename Byte>
struct Streams {
  struct Stream {
    Byte* begin;
    std::size_t bytes;
  };
  std::vector<Stream> list;

  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const Stream& stream : list) sum += stream.bytes;
    return sum;
  }
};

struct CopyJob {
  Streams<const unsigned char> reads;
  Streams<unsigned char> writes;

  template <typename T>
  void Read(const T* begin, std::size_t count) {
    reads.list.push_back(
        {reinterpret_cast<const unsigned char*>(begin), count * sizeof(T)});
  }
  void Write(float* begin, std::size_t count) {
    writes.list.push_back(
        {reinterpret_cast<unsigned char*>(begin), count * sizeof(float)});
  }
  std::size_t bytes() const { return reads.bytes() + writes.bytes(); }
};

// Walks over streams word by word: the first part of each stream in turn, then
// the second part of each, and so on. With one part, stream by stream.
template <typename Byte>
class StreamWalk {
 public:
  StreamWalk(const Streams<Byte>& streams, std::size_t parts,
             std::size_t word_bytes)
      : word_bytes_(word_bytes) {
    for (const auto& stream : streams.list) {
      const std::size_t part_bytes = stream.bytes / parts;
      places_.push_back({stream.begin, part_bytes});
    }
    end_ = places_.front().at + places_.front().part_bytes;
  }

  // The next word. May be called as often as there are words.
  Byte* Next() {
    Place* place = &places_[current_];
    if (place->at == end_) {
      current_ = current_ + 1 == places_.size() ? 0 : current_ + 1;
      place = &places_[current_];
      end_ = place->at + place->part_bytes;
    }
    Byte* const word = place->at;
    place->at += word_bytes_;
    return word;
  }

 private:
  struct Place {
    Byte* at;
    std::size_t part_bytes;
  };
  std::vector<Place> places_;
  std::size_t word_bytes_;
  std::size_t current_ = 0;
  Byte* end_;
};

// Pairs the words that are written with those that are read, evenly. Where more
// is written than read, some words are read again at once, from the nearest
// cache; where less is written, a word is made of several.
class CopyWalk {
 public:
  static constexpr std::size_t kMostReads = 32;

  struct Step {
    unsigned char* to;
    std::array<const unsigned char*, kMostReads> from;
    std::size_t reads = 0;
  };

  CopyWalk(const CopyJob& job, std::size_t parts, std::size_t word_bytes)
      : reads_(job.reads, parts, word_bytes),
        writes_(job.writes, parts, word_bytes),
        read_words_(job.reads.bytes() / word_bytes),
        write_words_(job.writes.bytes() / word_bytes),
        due_(write_words_ - 1) {
    if (read_words_ / write_words_ + 1 > kMostReads) {
      throw std::logic_error("CopyWalk: too many reads for one write");
    }
  }

  std::size_t steps() const { return write_words_; }

  // Valid until the next call. May be called steps() times.
  const Step& Next() {
    step_.to = writes_.Next();
    due_ += read_words_;
    if (due_ >= write_words_) step_.reads = 0;
    for (; due_ >= write_words_; due_ -= write_words_) {
      step_.from[step_.reads++] = reads_.Next();
    }
    return step_;
  }

 private:
  StreamWalk<const unsigned char> reads_;
  StreamWalk<unsigned char> writes_;
  std::size_t read_words_;
  std::size_t write_words_;
  std::size_t due_;  // read words, in units of 1 / write_words_
  Step step_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_COPY_JOB_H_
