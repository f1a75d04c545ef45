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

      # Opens the channel that the runner named, and removes the variable.
      def self.from_environment
        place = ENV.delete(VARIABLE).to_s
        number = place[/\Afd:(\d+)\z/, 1]
        raise ArgumentError, "#{VARIABLE} is `#{place}`, expected `fd:N`" unless number

        new(Integer(number, 10))
      end

      # Takes over the descriptor, and closes it in the plug-in's children.
      def initialize(descriptor)
        @stream = IO.for_fd(descriptor, "r+b", autoclose: false)
        @stream.close_on_exec = true
        @stream.sync = true
        @lock = Mutex.new
      end

      # Yields each line until the runner is gone.
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

      # Sends a notification. A text that is too long for a line is sent in parts.
      def notify(method, params)
        data = encode(method: method, params: params)
        text = params[:text]
        return write(data) if data.bytesize <= LINE_LIMIT || !text

        middle = text.length / 2
        [text[...middle], text[middle..]].each do |part|
          notify(method, params.merge(text: part))
        end
      end

      # Answers a request.
      def answer(number, result)
        write(encode(id: number, result: result))
      end

      # Refuses a request.
      def refuse(number, code, text)
        write(encode(id: number, error: { code: code, message: text }))
      end

      # Ends the process immediately: the runner is gone.
      def self.end_without_runner
        [$stdout, $stderr].each do |stream|
          stream.flush
        rescue SystemCallError, IOError
          next # its reader is gone, too
        end
        exit!(1)
      end

      private

      # Encodes one line. Non-finite numbers become null.
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

      # Writes a complete line, without exceptions of other threads.
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
