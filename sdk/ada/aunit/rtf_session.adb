--  SPDX-License-Identifier: Apache-2.0

with Ada.Directories;
with Ada.Environment_Variables;
with Ada.Strings.Fixed;
with Ada.Strings.Unbounded;
with GNAT.OS_Lib;
with GNAT.Task_Lock;
with Interfaces.C;
with Interfaces.C_Streams;
with System;

package body RTF_Session is

   use Ada.Strings.Unbounded;
   use Interfaces.C;

   --  Half of the longest packet: the text of a message, with its escapes.
   Longest_Text : constant := 32 * 1024;

   --  Constants of Linux.
   EINTR          : constant     := 4;
   FD_CLOEXEC     : constant int := 1;
   F_SETFD        : constant int := 2;
   MSG_NOSIGNAL   : constant int := 16#4000#;
   MSG_PEEK       : constant int := 16#2#;
   MSG_TRUNC      : constant int := 16#20#;
   SOCK_SEQPACKET : constant int := 5;
   SOL_SOCKET     : constant int := 1;
   SO_TYPE        : constant int := 3;

   function C_Send (FD : int; Data : System.Address; Size : size_t; Flags : int) return long
     with Import, Convention => C, External_Name => "send";

   function C_Receive
     (FD : int; Data : System.Address; Size : size_t; Flags : int) return long
     with Import, Convention => C, External_Name => "recv";

   function C_Get_Option
     (FD : int; Level : int; Option : int; Value : out int; Size : in out unsigned) return int
     with Import, Convention => C, External_Name => "getsockopt";

   function C_Control (FD : int; Command : int; Value : int) return int
     with Import, Convention => C_Variadic_2, External_Name => "fcntl";

   function C_Process_ID return int
     with Import, Convention => C, External_Name => "getpid";

   --  The socket in RTF_SESSION; -1 if there is none. Descendants that execute a program do not
   --  have it: the variable becomes `FD:N`.
   function Open_Socket return int;

   --  The answer to a packet that was sent.
   function Receive return String;

   --  The length of the valid UTF-8 sequence at an index; 0 if it is invalid.
   function UTF_8_Length (Text : String; Index : Positive) return Natural;

   --  The next character in a JSON string. Index moves behind it.
   function Escaped (Text : String; Index : in out Positive) return String;

   function Image (Value : Long_Float) return String is
     (Ada.Strings.Fixed.Trim (Long_Long_Float (Value)'Image, Ada.Strings.Both));

   function Open_Socket return int is
      Name : constant String := "RTF_SESSION";
      Text : constant String := Ada.Environment_Variables.Value (Name, "");
      Kind : int             := 0;
      Size : unsigned        := int'Size / 8;
      FD   : int;
   begin
      if Text'Length < 4 or else Text (Text'First .. Text'First + 2) not in "fd:" | "FD:"
      then
         return -1;
      end if;
      FD := int'Value (Text (Text'First + 3 .. Text'Last));
      if C_Get_Option (FD, SOL_SOCKET, SO_TYPE, Kind, Size) /= 0 or else Kind /= SOCK_SEQPACKET
      then
         return -1;
      end if;
      if C_Control (FD, F_SETFD, FD_CLOEXEC) /= 0 then
         return -1;
      end if;
      Ada.Environment_Variables.Set (Name, "FD:" & Text (Text'First + 3 .. Text'Last));
      --  So that a crash loses no complete line.
      declare
         use Interfaces.C_Streams;
         Done : constant Interfaces.C_Streams.int :=
           setvbuf (stdout, System.Null_Address, IOLBF, 4096);
         pragma Unreferenced (Done);
      begin
         return FD;
      end;
   exception
      when Constraint_Error =>
         return -1;
   end Open_Socket;

   Socket : int := Open_Socket;

   Owner : constant int := C_Process_ID;

   function Is_Open return Boolean is (Socket >= 0);

   function Is_Forked return Boolean is (C_Process_ID /= Owner);

   --  Whether a packet was sent.
   function Has_Sent (Packet : String) return Boolean;

   function Has_Sent (Packet : String) return Boolean is
      Sent : long;
   begin
      loop
         Sent := C_Send (Socket, Packet'Address, Packet'Length, MSG_NOSIGNAL);
         exit when Sent >= 0 or else GNAT.OS_Lib.Errno /= EINTR;
      end loop;
      return Sent >= 0;
   end Has_Sent;

   function Receive return String is
      First : Character := ' ';
      Size  : long;
   begin
      loop
         Size := C_Receive (Socket, First'Address, 1, MSG_PEEK + MSG_TRUNC);
         exit when Size >= 0 or else GNAT.OS_Lib.Errno /= EINTR;
      end loop;
      if Size <= 0 then
         return "";
      end if;
      declare
         Answer : String (1 .. Natural (Size));
      begin
         Size := C_Receive (Socket, Answer'Address, Answer'Length, 0);
         return Answer (1 .. Natural (long'Max (Size, 0)));
      end;
   end Receive;

   function Exchange (Method : String; Fields : String) return String is
      Call : constant String := """method"":""" & Method & """,""params"":{" & Fields & "}}";
   begin
      if not Is_Open then
         return "";
      elsif Is_Forked then
         --  The parent may wait for an answer at the same time, and another task may have had
         --  the lock at the fork.
         return (if Has_Sent ("{""answer"":false," & Call) then "0" else "");
      end if;
      GNAT.Task_Lock.Lock;
      declare
         Answer : constant String := (if Has_Sent ("{" & Call) then Receive else "");
      begin
         if Answer = "" then
            Socket := -1; --  the host has ended
         end if;
         GNAT.Task_Lock.Unlock;
         return Answer;
      end;
   end Exchange;

   procedure Send (Method : String; Fields : String) is
      Answer : constant String := Exchange (Method, Fields);
      pragma Unreferenced (Answer);
   begin
      null;
   end Send;

   function UTF_8_Length (Text : String; Index : Positive) return Natural is
      function Is_In (At_Index : Positive; Low, High : Natural) return Boolean is
        (At_Index <= Text'Last and then Character'Pos (Text (At_Index)) in Low .. High);

      First : constant Natural := Character'Pos (Text (Index));
      Low   : constant Natural := (case First is when 16#E0# => 16#A0#, when 16#F0# => 16#90#,
                                   when others => 16#80#);
      High  : constant Natural := (case First is when 16#ED# => 16#9F#, when 16#F4# => 16#8F#,
                                   when others => 16#BF#);
      Size  : constant Natural :=
        (case First is when 0 .. 16#7F# => 1, when 16#C2# .. 16#DF# => 2,
         when 16#E0# .. 16#EF# => 3, when 16#F0# .. 16#F4# => 4, when others => 0);
   begin
      if Size < 2 then
         return Size;
      end if;
      if not Is_In (Index + 1, Low, High) then
         return 0;
      end if;
      return (if (for all Rest in Index + 2 .. Index + Size - 1 => Is_In (Rest, 16#80#, 16#BF#))
              then Size else 0);
   end UTF_8_Length;

   function Escaped (Text : String; Index : in out Positive) return String is
      Digit : constant String   := "0123456789abcdef";
      Size  : constant Natural  := UTF_8_Length (Text, Index);
      First : constant Positive := Index;
      Code  : constant Natural  := Character'Pos (Text (First));
   begin
      Index := Index + Natural'Max (Size, 1);
      if Size = 0 then
         --  Latin-1
         return Character'Val (16#C0# + Code / 64) & Character'Val (16#80# + Code mod 64);
      elsif Text (First) = '"' or else Text (First) = '\' then
         return "\" & Text (First);
      elsif Code < 32 then
         return "\u00" & Digit (Code / 16 + 1) & Digit (Code mod 16 + 1);
      else
         return Text (First .. Index - 1);
      end if;
   end Escaped;

   function Quoted (Text : String) return String is
      JSON  : Unbounded_String := To_Unbounded_String ("""");
      Index : Positive         := Text'First;
   begin
      while Index <= Text'Last loop
         Append (JSON, Escaped (Text, Index));
      end loop;
      return To_String (JSON) & '"';
   end Quoted;

   procedure Send_Message (Kind : String; Text : String; More : String := "") is
      Index : Positive := Text'First;
   begin
      loop
         declare
            JSON : Unbounded_String;
         begin
            while Index <= Text'Last and then Length (JSON) < Longest_Text loop
               Append (JSON, Escaped (Text, Index));
            end loop;
            Send
              ("message",
               """kind"":""" & Kind & """,""text"":""" & To_String (JSON) & '"' & More);
         end;
         exit when Index > Text'Last;
      end loop;
   end Send_Message;

   function Measure
     (Name  : String;
      Value : Long_Float;
      Unit  : String     := "";
      Low   : Long_Float := Lowest;
      High  : Long_Float := Highest) return Boolean
   is
      Is_Finite : constant Boolean := Value'Valid;
      Fields    : constant String  :=
        """name"":" & Quoted (Name) & ",""unit"":" & Quoted (Unit)
        & (if Low > Lowest then ",""low"":" & Image (Low) else "")
        & (if High < Highest then ",""high"":" & Image (High) else "")
        & ",""value"":" & (if Is_Finite then Image (Value) else "null");
   begin
      Send ("measured", Fields);
      return Is_Finite and then Value in Low .. High;
   end Measure;

   procedure Measure
     (Name  : String;
      Value : Long_Float;
      Unit  : String     := "";
      Low   : Long_Float := Lowest;
      High  : Long_Float := Highest)
   is
      Is_Within : constant Boolean := Measure (Name, Value, Unit, Low, High);
      pragma Unreferenced (Is_Within);
   begin
      null;
   end Measure;

   procedure Attach (Path : String; Name : String := ""; Media_Type : String := "") is
   begin
      if not Ada.Directories.Exists (Path) then
         Send_Message ("error", "there is no file `" & Path & "` to attach");
         return;
      end if;
      Send
        ("attached",
         """name"":" & Quoted (if Name = "" then Ada.Directories.Simple_Name (Path) else Name)
         & ",""path"":" & Quoted (Ada.Directories.Full_Name (Path))
         & ",""media_type"":" & Quoted (Media_Type));
   end Attach;

   procedure Report (Text : String) is
   begin
      Send_Message ("report", Text);
   end Report;

end RTF_Session;
