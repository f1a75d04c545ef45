# frozen_string_literal: true

require "rtf/judge"
require "rtf/location"
require "rtf/sampling"
require "rtf/text"

module RTF
  # What the runner asks to be done with a plug-in.
  class Task
    attr_reader :file, :name, :param, :environment, :args, :repetition, :shared

    # Where copies of attached files go: of a test, or while a fixture is told of one.
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
      @shared = text(params, "end_marker", "")
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

  # The link between one plug-in and the runner: what it tells, from any thread,
  # and what went wrong first.
  class Session
    attr_reader :task, :judge, :sampling

    @current = nil

    class << self
      # Makes `session` the one that plug-ins talk to; a process has one at a time.
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

    # Serves `task`; `channel` tells the runner.
    def initialize(task, judge, channel)
      @task = task
      @judge = judge
      @channel = channel
      @sampling = Sampling.new { |method, params| channel.notify(method, params) }
    end

    # Tells the runner something, after what was sampled before.
    def notify(method, params)
      @sampling.send_pending
      @channel.notify(method, params)
    end

    # Sends a message of the plug-in with the place it was written at.
    def message(kind, text, location: Location.caller_place, **more)
      params = { kind: kind, text: Text.utf8(text) }
      params[:location] = location if location
      notify("message", params.merge(more.compact))
    end

    # Sends a failure and keeps it if it is the first problem.
    def failure(text, **more)
      text = Text.utf8(text)
      @judge.note_failure(text)
      message("failure", text, **more)
    end

    # Sends an error and keeps it if it is the first problem.
    def error(reason, text: reason, **more)
      @judge.note("error", Text.utf8(reason))
      message("error", text, **more)
    end

    # Sends a measurement; one outside its limits is a problem like a failed check.
    def measured(name, value, unit, low, high)
      params = { name: name, value: value, unit: unit, low: low, high: high,
                 location: Location.caller_place }
      good = value.finite? && (low.nil? || value >= low) && (high.nil? || value <= high)
      @judge.note_failure(Text.violation(name, value, unit, low, high)) unless good
      notify("measured", params.compact)
      good
    end

    # Keeps a sample; one outside its limits is a problem like a failed check.
    def sampled(signal, value, at)
      at = @sampling.take(signal, value, at)
      return true if signal.hold?(value)

      decides = @judge.first.nil?
      what = "#{signal.name} at #{Text.number(at)} s"
      @judge.note_failure(Text.violation(what, value, signal.unit, signal.low, signal.high))
      # It must not get lost.
      @sampling.send_pending if decides
      false
    end
  end
end
