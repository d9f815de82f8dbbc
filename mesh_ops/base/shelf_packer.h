#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace rebake {

/// Packs rectangles into pages by shelves: from left to right, and a shelf is as high as its highest rectangle. Good
/// for rectangles that come sorted by height.
class ShelfPacker {
 public:
  /// `width`: of all pages; no rectangle may be wider. `max_height`: of a page; no rectangle may be higher.
  ShelfPacker(int width, int max_height) : width_(width), max_height_(max_height) {}

  struct Place {
    std::size_t page;
    int x, y;
  };
  Place add(int width, int height) {
    if (x_ + width > width_) {
      x_ = 0;
      y_ += shelf_;
      shelf_ = 0;
    }
    if (y_ + height > max_height_) {
      pages_.emplace_back();
      x_ = y_ = shelf_ = 0;
    }
    const Place place{pages_.size() - 1, x_, y_};
    x_ += width;
    shelf_ = std::max(shelf_, height);
    pages_.back().width = std::max(pages_.back().width, x_);
    pages_.back().height = std::max(pages_.back().height, y_ + shelf_);
    return place;
  }

  /// The used size of a page.
  struct Page {
    int width = 0, height = 0;
  };
  /// At least one; an empty page has size 0.
  const std::vector<Page>& pages() const { return pages_; }

 private:
  int width_, max_height_;
  int x_ = 0, y_ = 0, shelf_ = 0;
  std::vector<Page> pages_{1};
};

}  // namespace rebake
