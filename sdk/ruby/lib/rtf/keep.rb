# frozen_string_literal: true

module RTF
  # Copies of files that tests attach.
  module Keep
    module_function

    KINDS = { "directory" => "a directory", "fifo" => "a FIFO" }.freeze

    # Raises an error that says why something cannot be attached: only files can.
    def check(path)
      return if File.file?(path)
      raise Errno::ENOENT, "there is no file `#{path}` to attach" unless File.exist?(path)

      kind = KINDS.fetch(File.ftype(File.realpath(path)), "a device or a socket")
      raise IOError, "`#{path}` cannot be attached: it is #{kind}, not a file"
    end

    # Copies a file into `folder`, under a name that no other has; returns where.
    def copy(path, name, folder)
      make(folder)
      safe = name.gsub(/[^[:alnum:].\-_]/, "_")
      1.step do |number|
        target = File.join(folder, "#{number}-#{safe}")
        File.open(target, File::WRONLY | File::CREAT | File::EXCL | File::BINARY) do |kept|
          IO.copy_stream(path, kept)
        end
        return target
      rescue Errno::EEXIST
        next
      end
    end

    def make(folder)
      return if File.directory?(folder)

      make(File.dirname(folder))
      Dir.mkdir(folder)
    rescue Errno::EEXIST
      # Another thread was faster.
    end
  end
end
