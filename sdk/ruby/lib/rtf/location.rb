# frozen_string_literal: true

module RTF
  # Locations in the plug-in's source.
  module Location
    # The SDK's directory: its lines are never the plug-in's.
    DIRECTORY = "#{File.expand_path("..", __dir__)}/".freeze

    module_function

    # The innermost line outside the SDK: the plug-in's line.
    def caller_place
      place_of(Kernel.caller_locations(1).find { |frame| foreign?(frame) })
    end

    # The innermost line of `file` in an exception's backtrace, otherwise the
    # innermost line outside the SDK.
    def of_exception(problem, file)
      if problem.is_a?(SyntaxError) && (found = problem.message.match(/\A(.+?):(\d+):/))
        return { file: found[1], line: found[2].to_i }
      end

      frames = (problem.backtrace_locations || []).select { |frame| foreign?(frame) }
      place_of(frames.find { |frame| frame.path == file } || frames.first)
    end

    # The lines of the backtrace of an exception or a thread that are neither the
    # SDK's nor the interpreter's own.
    def backtrace(of)
      (of.backtrace || []).reject { |line| line.start_with?(DIRECTORY, "<internal:", "-e:") }
    end

    def place_of(frame)
      frame && { file: frame.path, line: frame.lineno }
    end

    def foreign?(frame)
      path = frame.path
      path && !path.start_with?(DIRECTORY) && !path.start_with?("<internal:") && path != "-e"
    end
  end
end
