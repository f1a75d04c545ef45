# frozen_string_literal: true

require "json"

require "rtf/text"

module RTF
  module Host
    # The channel to the runner: JSON-RPC 2.0, one message a line.
    class Channel
      VARIABLE = "RTF_CHANNEL"
      READ_BYTES = 65_536
      # The longest line that the runner accepts, its end included.
      LINE_LIMIT = 16 * 1024 * 1024
      REASON_LIMIT = 10_000

      # Opens the channel that the runner named, and takes its name away.
      def self.from_environment
        place = ENV.delete(VARIABLE).to_s
        number = place[/\Afd:(\d+)\z/, 1]
        raise ArgumentError, "#{VARIABLE} is `#{place}`, expected `fd:N`" unless number

        new(Integer(number, 10))
      end

      # Takes over the descriptor, and keeps it from the plug-in's children.
      def initialize(descriptor)
        @stream = IO.for_fd(descriptor, "r+b", autoclose: false)
        @stream.close_on_exec = true
        @stream.sync = true
        @lock = Mutex.new
      end

      # Yields each line until the runner has gone.
      def each_line(&block)
        rest = +""
        loop do
          rest << @stream.readpartial(READ_BYTES)
          *whole, rest = rest.split("\n", -1)
          whole.each(&block)
        end
      rescue EOFError, Errno::ECONNRESET
        nil
      end

      # Tells the runner something. A text that is too long for a line is sent in parts.
      def notify(method, params)
        data = encode(method: method, params: params)
        text = params[:text]
        return write(data) if data.bytesize <= LINE_LIMIT || !text

        middle = text.length / 2
        [text[...middle], text[middle..]].each do |part|
          notify(method, params.merge(text: part))
        end
      end

      # Answers a request that was carried out.
      def answer(number, result)
        data = encode(id: number, result: result)
        if data.bytesize > LINE_LIMIT
          # The whole reason was sent as a message before; what is left names it.
          data = encode(id: number, result: result.merge(reason: result[:reason][...REASON_LIMIT]))
        end
        write(data)
      end

      # Answers a request that cannot be carried out.
      def refuse(number, code, text)
        write(encode(id: number, error: { code: code, message: text }))
      end

      # Ends the process at once: nobody is left to run tests for.
      def self.end_without_runner
        [$stdout, $stderr].each do |stream|
          stream.flush
        rescue SystemCallError, IOError
          next # whoever read it is gone too
        end
        exit!(1)
      end

      private

      # JSON has no numbers that are not finite: they become null.
      def encode(fields)
        line = { jsonrpc: "2.0", **fields }
        "#{JSON.generate(line)}\n"
      rescue JSON::GeneratorError
        "#{JSON.generate(finite(line))}\n"
      end

      def finite(value)
        case value
        when Float then value.finite? ? value : nil
        when String then Text.utf8(value)
        when Hash then value.transform_values { |entry| finite(entry) }
        when Array then value.map { |entry| finite(entry) }
        else value
        end
      end

      # A line that was begun is written to its end, whatever is raised into
      # the thread meanwhile.
      def write(data)
        Thread.handle_interrupt(Object => :never) do
          @lock.synchronize { @stream.write(data) }
        end
      rescue Errno::EPIPE, Errno::ECONNRESET
        Channel.end_without_runner
      end
    end
  end
end
