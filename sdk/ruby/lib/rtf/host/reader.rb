# frozen_string_literal: true

require "json"

require "rtf/judge"

module RTF
  module Host
    # What the runner waits for an answer to.
    class Request
      attr_reader :number, :method, :params, :judge

      # Takes a message that has a number and a method.
      def initialize(message)
        @number = message["id"]
        @method = message["method"]
        params = message["params"]
        @params = params.is_a?(Hash) ? params : {}
        @judge = Judge.new
      end
    end

    # Reads the channel; requests to stop, and for stacks, get through while a
    # plug-in runs.
    class Reader
      PARSE_ERROR = -32_700
      INVALID_REQUEST = -32_600
      # A plug-in that looks at `interrupted?` gets this long to end by itself.
      # Then Interrupted is raised in it, so that its tear-down still runs.
      POLITE_SECONDS = 0.5
      # A plug-in may rescue that: it comes again after this time.
      AGAIN_SECONDS = 0.1

      # Starts reading in a thread that does not keep the process alive.
      def initialize(channel)
        @channel = channel
        @requests = Queue.new
        @open = []
        @last_answered = false
        @fixture_up = false
        @lock = Mutex.new
        @main = Thread.current
        Threads.start("rtf channel") { read }
      end

      # The next request; nil when the runner has gone.
      def next
        @requests.pop
      end

      # Forgets a request that is about to be answered: the runner may go then.
      # It may not while a fixture is up, which nobody else would stop. After the
      # last one, requests that have not started, or that still arrive, are ignored.
      def finish(request, fixture_up:, last: false)
        request.judge.finish
        @lock.synchronize do
          @open.delete(request)
          @open.clear if last
          @last_answered ||= last
          @fixture_up = fixture_up
        end
      end

      private

      def read
        @channel.each_line { |line| take(line) }
        busy = @lock.synchronize { @open.any? || @fixture_up }
        Channel.end_without_runner if busy
        @requests.push(nil)
      end

      def take(line)
        message = JSON.parse(line)
        return dispatch(message) if message.is_a?(Hash) && message["method"].is_a?(String)

        @channel.refuse(nil, INVALID_REQUEST, "not a request")
      rescue JSON::ParserError, EncodingError => problem
        @channel.refuse(nil, PARSE_ERROR, "not a JSON text: #{problem.message[0, 200]}")
      end

      def dispatch(message)
        case message["method"]
        when "interrupt" then interrupt(**interruption(message["params"]))
        when "dump-stack" then @channel.notify("stack", { text: Threads.stacks(@main) })
        else
          return if message["id"].nil?

          request = Request.new(message)
          @lock.synchronize { @open << request unless @last_answered }
          @requests.push(request)
        end
      end

      def interruption(params)
        params = {} unless params.is_a?(Hash)
        { reason: params["reason"] || "asked to stop", number: params["request"] }
      end

      def interrupt(reason:, number:)
        waiting = @lock.synchronize { @open.dup }
        # Another one's turn: this one was answered, and the two have crossed.
        waiting = waiting.take(1).select { |request| request.number == number } if number
        waiting.each { |request| request.judge.request_stop(reason.to_s) }
        # It may hang, and be stopped by force.
        Session.running&.sampling&.send_pending
        first = waiting.first
        Threads.start("rtf stop") { insist(first.judge) } if first
      end

      def insist(judge)
        seconds = POLITE_SECONDS
        until judge.wait_for_end(seconds)
          judge.insist
          seconds = AGAIN_SECONDS
        end
      end
    end
  end
end
