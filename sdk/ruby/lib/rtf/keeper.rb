# frozen_string_literal: true

require "rtf/keep"
require "rtf/session"

module RTF
  # What a test, or a fixture in its `test_finished`, keeps with the result: numbers
  # and files.
  module Keeper
    # Keeps a number with the result; outside its limits it is a failure. A value
    # that is not a finite number lies outside any limits.
    def measure(name, value, unit = "", low: nil, high: nil)
      low, high = [low, high].map { |limit| limit && Float(limit) }
      if [low, high].compact.any?(&:nan?)
        raise ArgumentError, "a limit of `#{name}` is not a number"
      end

      Session.current.measured(Text.utf8(name), Float(value), Text.utf8(unit), low, high)
    end

    # Keeps a file with the result. It is copied now: write it before, to its end.
    def attach(path, name: nil, media_type: nil)
      full = File.expand_path(path)
      Keep.check(full)
      name = Text.utf8(name || File.basename(full))
      session = Session.current
      folder = session.task.attachments_dir
      full = Keep.copy(full, name, folder) unless folder.empty?
      params = { name: name, path: Text.utf8(full), media_type: Text.utf8(media_type) }
      session.notify("attached", params)
    end
  end
end
