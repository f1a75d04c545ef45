# frozen_string_literal: true

require "rtf/location"
require "rtf/request_state"
require "rtf/sampling"
require "rtf/text"

module RTF
  # The parameters of a plug-in.
  class Task
    attr_reader :file, :name, :param, :environment, :args, :repetition, :end_marker

    # The directory for copies of attached files.
    attr_accessor :attachments_dir

    # Reads the parameters of `run-test` or `set-up-fixture`.
    def initialize(params)
      @file = text(params, "file")
      @name = text(params, "name")
      @param = text(params, "param", "")
      @environment = text(params, "environment", "")
      @attachments_dir = text(params, "attachments_dir", "")
      @args = params.fetch("args", [])
      @repetition = params.fetch("repetition", 0)
      @last = params["is_last"] == true
      @end_marker = text(params, "end_marker", "")
      strings = @args.is_a?(Array) && @args.all?(String)
      raise TypeError, "`args` is not a list of texts" unless strings
      raise TypeError, "`repetition` is not a whole number" unless @repetition.is_a?(Integer)
    end

    def last?
      @last
    end

    private

    def text(params, name, default = nil)
      value = params.fetch(name, default)
      raise TypeError, "`#{name}` is missing or not a text" unless value.is_a?(String)

      value
    end
  end

  # The connection between one plug-in and the runner, for any thread.
  class Session
    attr_reader :task, :request, :sampling

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
    end

    # Sends a notification, after the samples that were taken before.
    def notify(method, params)
      @sampling.send_pending
      @channel.notify(method, params)
    end

    # Sends a message of the plug-in with its location.
    def message(kind, text, location: Location.caller_place, **more)
      params = { kind: kind, text: Text.utf8(text) }
      params[:location] = location if location
      notify("message", params.merge(more.compact))
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

    # Sends a measurement, and returns whether it is within its limits.
    def measured(signal, value)
      @request.record("failed") unless signal.accept?(value)
      params = signal.to_h.merge(value: value, location: Location.caller_place)
      notify("measured", params.compact)
      signal.accept?(value)
    end

    # Adds a sample, and returns whether it is within its limits.
    def sampled(signal, value, at)
      accepted = signal.accept?(value)
      @request.record("failed") unless accepted
      @sampling.add(signal, value, at, accepted: accepted)
      accepted
    end
  end
end
