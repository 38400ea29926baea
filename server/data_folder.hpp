// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>

// Where the service keeps bytes:
//
//   DATA/work/SERVER/ID/       an execution while it lasts
//   DATA/jobs/ID/              an acknowledged job: call.json, body, ref-N as asked; out/ once it is done
//   DATA/uploads/ID/           an upload: body, upload.json
//   DATA/reserve               room for writing down how jobs ended when nothing else is left
//
// What has its final name is complete: everything is written under another, flushed, renamed, and the folder flushed.
namespace terrane {

/// 32 hexadecimal digits that nobody can guess.
std::string random_id();
bool is_id(std::string_view text);

/// Writes a whole file that does not exist yet. Throws Error{storage_full | internal}.
void write_file(const std::filesystem::path& path, std::string_view content);
/// Every file in a folder, and the folder itself, are on stable storage when it returns.
void flush_folder(const std::filesystem::path& folder);
/// Both on one file system; the folder of the new name is flushed too. An existing folder of that name is removed first.
void rename_flushed(const std::filesystem::path& from, const std::filesystem::path& to);

/// A file written in pieces. Throws as write_file does; what is not kept is removed.
class NewFile {
 public:
  explicit NewFile(std::filesystem::path path);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  void write(std::string_view piece);
  void keep();

 private:
  std::filesystem::path path_;
  int file_;
  bool kept_ = false;
};

/// A folder that is removed with all that is in it, unless it was given another name.
class Folder {
 public:
  explicit Folder(std::filesystem::path path);
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Flushes it and gives it its lasting name; afterwards it stays.
  void become(const std::filesystem::path& name);

 private:
  std::filesystem::path path_;
  bool stays_ = false;
};

class DataFolder {
 public:
  /// Makes what is not there yet; takes the reserve. `server`: a name no other server in the same folder has; what a
  /// server of that name left in work/ is removed. `alone`: no other server may have the folder at the same time. Throws
  /// Error{usage} "bad-data-folder", "data-folder-in-use".
  DataFolder(std::filesystem::path root, const std::string& server, bool alone);
  ~DataFolder();
  DataFolder(const DataFolder&) = delete;
  DataFolder& operator=(const DataFolder&) = delete;

  std::filesystem::path root() const { return root_; }
  std::filesystem::path work() const { return root_ / "work" / server_; }
  std::filesystem::path work(const std::string& id) const { return work() / id; }
  std::filesystem::path job(const std::string& id) const { return root_ / "jobs" / id; }
  std::filesystem::path uploads() const { return root_ / "uploads"; }
  std::filesystem::path upload(const std::string& id) const { return uploads() / id; }

  /// Removes what nobody has changed for so long from a folder.
  void remove_older(const std::filesystem::path& folder, std::chrono::milliseconds age) const;

  /// Gives the reserve back to the file system, so that what must be written can be.
  void release_reserve() const;
  /// Takes it again; false when there is no room.
  bool take_reserve() const;
  /// Before new work: without the reserve there is room for nothing but what must be written. Throws Error{storage_full}.
  void require_reserve() const;

 private:
  void lock();

  std::filesystem::path root_;
  std::string server_;
  int lock_ = -1;
};

/// The folder of `terrane serve` without --data: the user's state directory.
std::filesystem::path default_data_folder();

}  // namespace terrane
