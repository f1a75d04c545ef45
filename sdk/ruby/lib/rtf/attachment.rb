# frozen_string_literal: true

module RTF
  # Copies attached files into the results.
  module Attachment
    module_function

    TYPES = { "directory" => "a directory", "fifo" => "a FIFO" }.freeze

    # Raises an error that says why a path cannot be attached: only files can.
    def check(path)
      return if File.file?(path)
      raise Errno::ENOENT, "there is no file `#{path}` to attach" unless File.exist?(path)

      type = TYPES.fetch(File.ftype(File.realpath(path)), "a device or a socket")
      raise IOError, "`#{path}` cannot be attached: it is #{type}, not a file"
    end

    # Copies a file into `directory` under a unique name, and returns the copy's path.
    # A name without an extension gets that of the file.
    def copy(path, name, directory)
      make_directory(directory)
      name += File.extname(path) if File.extname(name).empty?
      safe = name.gsub(/[^[:alnum:].\-_]/, "_")
      1.step do |number|
        target = File.join(directory, "#{number}-#{safe}")
        File.open(target, File::WRONLY | File::CREAT | File::EXCL | File::BINARY) do |output|
          IO.copy_stream(path, output)
        end
        return target
      rescue Errno::EEXIST
        next
      end
    end

    def make_directory(directory)
      return if File.directory?(directory)

      make_directory(File.dirname(directory))
      Dir.mkdir(directory)
    rescue Errno::EEXIST
      # Another thread was faster.
    end
  end
end
