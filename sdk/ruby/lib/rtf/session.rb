# frozen_string_literal: true

require "rtf/attachment"
require "rtf/cases"
require "rtf/location"
require "rtf/questions"
require "rtf/request_state"
require "rtf/sampling"
require "rtf/stop"
require "rtf/task"
require "rtf/text"

module RTF
  # The connection between one plug-in and the runner, for any thread.
  class Session
    # `phase` is the announced step of a test, and nil in a fixture.
    attr_reader :task, :request, :sampling, :cases, :phase

    @current = nil

    class << self
      # Makes `session` the present one; a process has one at a time.
      def enter(session)
        @current = session
      end

      # The session of the plug-in that runs, if any.
      def running
        @current
      end

      # The session of the plug-in that runs.
      def current
        @current or raise "this works only in a plug-in that `rtf run` has started; " \
                          "try `rtf run FILE`"
      end
    end

    # Serves `task`; `channel` leads to the runner.
    def initialize(task, request, channel)
      @task = task
      @request = request
      @channel = channel
      @sampling = Sampling.new { |method, params| channel.notify(method, params) }
      @cases = Cases.new(self)
      @phase = nil
    end

    # Announces a step of a test.
    def announce(phase)
      @phase = phase
      notify("phase", { phase: phase })
    end

    # Sends a notification, after the samples that were taken before.
    def notify(method, params)
      @sampling.send_pending
      @channel.notify(method, params)
    end

    # Sends a notification that belongs to the present case, if any.
    def notify_in_case(method, params)
      number = @cases.current
      params[:case] = number if number
      notify(method, params)
    end

    # Attaches a file, and returns the path of the copy.
    def attach(path, name, media_type, picture: nil)
      name = Text.utf8(name)
      directory = @task.attachments_dir
      path = Attachment.copy(path, name, directory) unless directory.empty?
      path = Text.utf8(path)
      params = { name: name, path: path, media_type: Text.utf8(media_type), picture: picture }
      notify_in_case("attached", params.compact)
      path
    end

    # Asks an operator, and returns the answer.
    def ask(text, choices, **options)
      require_setup_or_run("questions are allowed in `setup` and `run` of a test only")
      end_with_error("a process that the plug-in forked cannot ask") if @cases.forked?
      Questions.new(self).ask(text, choices, **options)
    end

    # Sends a message of the plug-in with its location.
    def message(kind, text, location: Location.caller_place, **more)
      params = { kind: kind, text: Text.utf8(text) }
      params[:location] = location if location
      notify_in_case("message", params.merge(more.compact))
    end

    # Sends a failure.
    def failure(text, **more)
      @request.record("failed")
      message("failure", text, **more)
    end

    # Sends an error.
    def error(text, **more)
      @request.record("error")
      message("error", text, **more)
    end

    # Sends an error, which ends the step.
    def end_with_error(text)
      error(text)
      raise AssertionEnded, text.to_s
    end

    # Sends an exception as an error, with its class, text, location and backtrace.
    def exception(problem)
      reason = "#{problem.class}: #{Text.utf8(problem.message)}"
      place = Location.of_exception(problem, @task.file)
      lines = Location.backtrace(problem).map { |line| "  from #{Text.utf8(line)}" }
      error([reason, *lines].join("\n"), location: place)
    end

    # Skips the innermost case of this thread, or without one the test.
    def skip(reason)
      reason = Text.utf8(reason)
      if (opened = @cases.innermost)
        opened.skip_reason ||= reason
      else
        require_setup_or_run("`skip` is allowed in `setup` and `run` only")
        @request.skip(reason)
      end
      raise Skipped, reason
    end

    # Announces cases.
    def plan_cases(names)
      require_setup_or_run("cases are planned in `setup` and `run` only")
      @cases.plan(names)
    end

    # The value with this name. For an unknown name, reports `problem` and the known names.
    def value_of(values, name, problem)
      values.fetch(name.to_s) do
        end_with_error("#{problem} #{values.empty? ? "none" : values.keys.join(", ")}")
      end
    end

    # Sends a value of a fixture. A forked child sends none, like a case.
    def provide(name, value)
      notify("provided", { name: name, value: value }) unless @cases.forked?
    end

    # Sends a measurement, and returns whether it is within its limits.
    def measured(signal, value)
      @request.record("failed") unless signal.accept?(value)
      params = signal.to_h.merge(value: value, location: Location.caller_place)
      notify_in_case("measured", params.compact)
      signal.accept?(value)
    end

    # Asks the runner to compare a signal with a stored trajectory.
    def check_trajectory(params)
      params = params.merge(location: Location.caller_place)
      notify_in_case("trajectory", params.compact)
    end

    # Adds a sample, and returns whether it is within its limits.
    def sampled(signal, value, at)
      accepted = signal.accept?(value)
      @request.record("failed") unless accepted
      @sampling.add([signal, @cases.current], value, at, accepted: accepted)
      accepted
    end

    # Declares a formula that judges the rest of the test.
    def monitor(name, formula, severity)
      params = { name: name.to_s, formula: formula.to_s, severity: severity }
      notify("monitor", params.merge(location: Location.caller_place).compact)
    end

    private

    def require_setup_or_run(text)
      end_with_error(text) unless %w[setup run].include?(@phase)
    end
  end
end
